"""Ours and the peers a user could install, side by side: ``make bench``."""
