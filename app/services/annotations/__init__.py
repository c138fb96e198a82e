"""Annotations of clips in time: kept, imported, exported and suggested."""
