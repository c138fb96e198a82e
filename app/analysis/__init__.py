"""From a canonical motion to its descriptors."""
