"""Edits of clips that make new clips."""
