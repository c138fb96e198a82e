"""The commands `kinedex evaluate ...`."""
