"""Synthesizes motions that were not recorded."""
