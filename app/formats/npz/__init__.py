"""NumPy arrays of positions, and SMPL parameters."""
