"""Everything that is keyed by a clip."""
