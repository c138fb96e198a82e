"""Words as people write them: inflections, meaning, sentences."""
