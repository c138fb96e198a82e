"""Left and right in the labels of a mirrored motion."""

from __future__ import annotations

import pytest

from app.services.editing.sided_texts import exchanged, exchanged_labels
from app.store.clips.record import ClipLabels


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("right leg kick", "left leg kick"),
        ("left_leg", "right_leg"),
        ("LeftLeg", "RightLeg"),
        ("from LEFT to right", "from RIGHT to left"),
        ("left-handed, upright", "right-handed, upright"),
        ("turns clockwise", "turns counterclockwise"),
        ("turns anti-clockwise", "turns clockwise"),
        ("bright, leftover, cleft", "bright, leftover, cleft"),
        ("steps leftwards", "steps rightwards"),
    ],
)
def test_sides_change_and_nothing_else(text: str, other: str) -> None:
    assert exchanged(text) == other


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
