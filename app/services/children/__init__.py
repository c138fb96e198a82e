"""Child processes: starting them, a pool that gives them tasks, and the reason of their end."""
