"""Steps between keyposes, and cycles."""
