"""Models that are fitted on a library: frozen records of arrays, and pure functions."""
