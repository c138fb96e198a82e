"""Left and right in the labels of a mirrored motion."""

from __future__ import annotations

from app.services.editing.sided_texts import exchanged_labels
from app.store.clips.record import ClipLabels


def test_labels_are_exchanged_but_for_person_license_and_source() -> None:
    labels = ClipLabels(
        name="left punch",
        person="Left",
        task="left punch",
        words=("left_arm", "punch"),
        license="left",
        source="right",
        metadata={"foot": "right", "age": 3},
        captions=("a punch with the left hand",),
    )
    assert exchanged_labels(labels) == ClipLabels(
        name="right punch",
        person="Left",
        task="right punch",
        words=("right_arm", "punch"),
        license="left",
        source="right",
        metadata={"foot": "left", "age": 3},
        captions=("a punch with the right hand",),
    )
