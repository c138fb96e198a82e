"""Two clips of the library, compared moment by moment."""
