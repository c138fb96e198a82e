"""Search inside long clips."""
