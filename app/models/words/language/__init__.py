"""English words in queries: inflections, meanings, sentences."""
