"""Retrieval rates and confusion matrices (Sun 2011)."""
