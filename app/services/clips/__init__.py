"""Clips: take in, analyze, list, change, remove."""
