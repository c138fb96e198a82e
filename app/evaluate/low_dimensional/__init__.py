"""Errors of low-dimensional motion (Perera 2009)."""
