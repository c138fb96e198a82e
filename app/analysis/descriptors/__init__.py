"""Descriptors: the vectors by which clips, windows and poses are compared."""
