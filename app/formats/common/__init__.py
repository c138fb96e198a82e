"""What several formats share: numbers, lines, names, limits, forward kinematics in blocks."""
