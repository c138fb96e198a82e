"""Joint roles: which joint of a skeleton is, for example, the left knee."""
