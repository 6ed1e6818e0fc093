"""``wct``: parses and prints, nothing else."""
