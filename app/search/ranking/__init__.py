"""Rankings, their pages and cursors."""
