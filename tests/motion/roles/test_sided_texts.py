from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.motion.roles.sided_texts import exchanged


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("walk-turn-left", "walk-turn-right"),
        ("LeftLeg", "RightLeg"),
        ("RIGHT hand", "LEFT hand"),
        ("turns clockwise", "turns counterclockwise"),
        ("stands upright, leftovers", "stands upright, leftovers"),
        ("from left to right", "from right to left"),
        ("right leg kick", "left leg kick"),
        ("left_leg", "right_leg"),
        ("from LEFT to right", "from RIGHT to left"),
        ("left-handed, upright", "right-handed, upright"),
        ("turns anti-clockwise", "turns clockwise"),
        ("bright, leftover, cleft", "bright, leftover, cleft"),
        ("steps leftwards", "steps rightwards"),
    ],
)
def test_sides_are_exchanged(text: str, other: str) -> None:
    assert exchanged(text) == other


@given(st.lists(st.sampled_from(["left", "right", "Left", "RIGHT", "walk", "upright"])))
def test_twice_is_the_same_text(words: list[str]) -> None:
    text = " ".join(words)
    assert exchanged(exchanged(text)) == text
