"""Power weights: linear programmes and what goes with them."""
