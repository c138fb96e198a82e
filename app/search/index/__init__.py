"""Rows in memory: filters and nearest neighbors."""
