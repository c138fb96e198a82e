"""Energy of a motion (Perera 2009, section 3.1), and the noise of its markers."""
