"""Precision and recall of keyposes against annotations (Perera 2009)."""
