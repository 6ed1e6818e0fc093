"""Power weights: where the search for them starts, the linear programmes that find them, proofs that there are none."""
