"""What a set of motions covers: speeds, turns, directions."""
