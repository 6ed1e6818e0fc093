"""Exact signs of polynomials of coordinates; knows no mesh."""
