"""BVH: reading every dialect, writing, exporting."""
