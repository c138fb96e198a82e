"""Vectors and labels of the clips in memory: filters and nearest neighbors."""
