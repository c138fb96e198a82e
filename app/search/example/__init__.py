"""Search by example: distances of clips, their fusion, and rankings in two stages."""
