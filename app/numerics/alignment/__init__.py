"""Dynamic time warping, whole and inside, and cross-correlation."""
