"""Canonical motion: meters, Y up, the true frame rate."""
