"""Imports of many files at once, from an archive or a folder."""
