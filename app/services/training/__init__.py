"""Fit the models, and decide when."""
