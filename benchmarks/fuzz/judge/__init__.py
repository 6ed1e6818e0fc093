"""Judges of what came out, in NumPy and fractions; nothing here imports ``wct_plugin``.

Each gives the faults it found, in words; none means that all is as promised.
"""
