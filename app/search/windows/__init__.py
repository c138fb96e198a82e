"""Search for parts of long clips."""
