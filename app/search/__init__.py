"""The index over motion vectors, shortlist and re-rank."""
