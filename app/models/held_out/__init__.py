"""Held-out figures of every model; fits and evaluations use them."""
