"""Which joint of a skeleton is the left knee."""
