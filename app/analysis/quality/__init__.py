"""Measures of a clip by which people keep a library clean."""
