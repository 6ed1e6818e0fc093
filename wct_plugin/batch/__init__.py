"""Many files through one pipeline."""
