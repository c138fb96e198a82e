"""Edits of a motion: cut, mirror, resample, in place, loop."""
