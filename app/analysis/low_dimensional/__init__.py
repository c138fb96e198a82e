"""Motion in few dimensions (Perera 2009, section 4)."""
