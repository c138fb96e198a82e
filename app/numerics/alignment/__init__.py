"""Dynamic time warping of whole sequences and of parts, and cross-correlation."""
