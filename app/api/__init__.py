"""The HTTP contract of DESIGN 8."""
