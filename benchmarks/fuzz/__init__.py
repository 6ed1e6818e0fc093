"""Random files, meshes, options and stops, each judged by code that shares nothing with the package: ``make fuzz``.

A case is a kind, a seed and a number, and nothing else: the same three give the same case. It runs in a child with
limits of memory and time; what it leaves is judged in :mod:`benchmarks.fuzz.judge`.
"""
