"""Indexes of vectors in memory, and rankings of clips."""
