"""What is fitted on a library: frozen records of arrays, pure functions."""
