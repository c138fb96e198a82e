"""Fits the models, and decides when a fit is due."""
