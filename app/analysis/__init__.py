"""Computes the arrays that describe a canonical motion."""
