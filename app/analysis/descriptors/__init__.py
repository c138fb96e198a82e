"""One vector, or a few, for each clip: what clips are compared by."""
