"""Held-out figures of all models, for fits and evaluations."""
