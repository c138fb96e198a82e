"""Search by example: distances, their fusion, re-ranking."""
