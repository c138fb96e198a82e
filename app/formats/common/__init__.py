"""Shared by the formats: numbers, lines, names, limits, forward kinematics in blocks."""
