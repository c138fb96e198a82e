"""Recognition of persons and tasks, held out (Vasilescu 2002, Perera 2009)."""
