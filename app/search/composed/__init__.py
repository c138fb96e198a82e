"""Queries of several parts: how likely each part is true of a clip, and of all parts together."""
