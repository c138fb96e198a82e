"""Search for frames with a similar pose."""
