"""Dances with known beats, keyposes and music: the ground truth for what analysis finds."""

from app.services.demo.dances.dance import dance

__all__ = ["dance"]
