"""Stops at the calls of the progress callback, in every stage, and at moments between: what is left is judged."""
