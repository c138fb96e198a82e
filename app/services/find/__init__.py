"""Every search, and the map of all clips."""
