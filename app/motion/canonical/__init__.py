"""Canonical motion: metres, Y up, the true frame rate."""
