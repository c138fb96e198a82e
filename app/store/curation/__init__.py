"""What curation finds and what people decide about it."""
