"""Near-duplicates: clips that show the same take, or almost the same motion."""
