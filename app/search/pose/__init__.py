"""Search by one pose."""
