"""Clips of invented persons and tasks, as an evaluation of recognition reads them."""

from __future__ import annotations

import numpy as np

from app.evaluate.recognition.clips import JudgedClips
from tests.models.factor_clips import factor_clips

LENGTH = 2 * 39 + 2
"""Numbers in a sample."""


def invented(
    persons: int = 5, tasks: int = 6, takes: int = 4, sources: int = 1, noise: float = 0.05
) -> JudgedClips:
    """Every person does every task; sources divide the persons."""
    # as long as two poses of 13 joints and the two numbers after them
    clips = factor_clips(persons, tasks, takes, noise=noise)
    samples = np.resize(clips.samples.T, (LENGTH, len(clips.persons))).T
    return JudgedClips(
        samples=samples,
        angles=samples,
        persons=clips.persons,
        tasks=clips.tasks,
        groups=[
            f"{who} {what} {take}"
            for who, what, take in zip(clips.persons, clips.tasks, clips.takes, strict=True)
        ],
        sources=[f"s{int(who[1:]) % sources}" for who in clips.persons],
    )


def some(clips: JudgedClips, index: np.ndarray) -> JudgedClips:
    """The clips at these indices."""
    chosen = np.asarray(index).tolist()
    persons, tasks, groups, sources = (
        [labels[i] for i in chosen]
        for labels in (clips.persons, clips.tasks, clips.groups, clips.sources)
    )
    return JudgedClips(clips.samples[chosen], persons, tasks, groups, sources)
