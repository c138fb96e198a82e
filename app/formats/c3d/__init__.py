"""C3D marker files."""
