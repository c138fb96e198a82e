"""Clips that differ from the others with their label."""
