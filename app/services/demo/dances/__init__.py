"""Dances with known beats, keyposes and music: the ground truth for what analysis finds."""

from app.services.demo.dances.dance import dance
from app.services.demo.dances.sound import Sound

__all__ = ["Sound", "dance"]
