"""Child processes: how they are made, a pool of them, and how they end."""
