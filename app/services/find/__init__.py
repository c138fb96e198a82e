"""All searches, and the map of all clips."""
