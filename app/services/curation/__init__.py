"""Curation: measures, near-duplicates, outliers within a label, and licenses."""
