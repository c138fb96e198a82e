"""Unfolding, N-mode SVD and rank-1 factors."""
