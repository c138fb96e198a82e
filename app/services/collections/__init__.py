"""Collections: named sets of clips or parts of clips, their export and their statistics."""
