"""Exchanges left and right in texts, for the labels of a mirrored motion."""

from __future__ import annotations

from dataclasses import replace

from app.motion.roles.sided_texts import exchanged
from app.store.clips.record import ClipLabels


def exchanged_labels(labels: ClipLabels) -> ClipLabels:
    """Labels with left and right exchanged, but for the person, the license and the source."""
    return replace(
        labels,
        name=exchanged(labels.name),
        task=None if labels.task is None else exchanged(labels.task),
        words=tuple(dict.fromkeys(map(exchanged, labels.words))),
        captions=tuple(dict.fromkeys(map(exchanged, labels.captions))),
        metadata={
            key: exchanged(value) if isinstance(value, str) else value
            for key, value in labels.metadata.items()
        },
    )
