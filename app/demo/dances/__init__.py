"""Dances with known beats, keyposes and music: the ground truth for tests of the analysis."""

from app.demo.dances.counts import FLOWING, STOPPING, Manner
from app.demo.dances.dance import dance
from app.demo.dances.sound import Sound

__all__ = ["FLOWING", "STOPPING", "Manner", "Sound", "dance"]
