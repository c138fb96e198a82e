"""Detectors know movements and moved parts of the body from their definitions."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.movement_signs import movement_signs
from app.models.words.detectors import (
    DETECTORS,
    body_detector,
    body_part,
    body_side,
    detect,
    evidence,
    movement_detector,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, walking, waving


def scores(positions: FloatArray) -> dict[str, float]:
    signs = movement_signs(body_track(motion_of(positions)))
    return dict(zip(DETECTORS, detect(signs[None])[0].tolist(), strict=True))


def test_each_movement_is_found_in_its_own_clip() -> None:
    walk, turn = scores(walking()), scores(walking(turn=0.5))
    run, still = scores(walking(speed=3.5, steps_hz=1.4)), scores(standing())
    assert walk["walk (measured)"] > 0.5 > max(still["walk (measured)"], run["walk (measured)"])
    assert run["run (measured)"] > 0.5 > walk["run (measured)"]
    assert turn["turn (measured)"] > 0.9
    assert walk["turn (measured)"] < 0.1
    assert all(0.0 <= score <= 1.0 for score in (*walk.values(), *still.values()))


def test_the_moved_side_of_the_body_is_found() -> None:
    wave, walk = scores(waving()), scores(walking())
    assert wave["right hand moves"] > 0.6
    assert wave["left hand moves"] < 0.1
    assert wave["both hands move"] < 0.2
    assert wave["right moves"] > 0.8
    assert walk["both feet move"] > 0.5
    assert wave["both feet move"] < 0.1


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ("turning", "turn (measured)"),
        ("spin", "turn (measured)"),
        ("jog", "run (measured)"),
        ("march", "walk (measured)"),
        ("gesture", None),  # a bow is a gesture, but a gesture need not be a bow
        ("fight", None),
        ("zebra", None),
    ],
)
def test_words_of_a_movement_and_its_kinds_have_a_detector(word: str, name: str | None) -> None:
    found = movement_detector(word)
    assert (None if found is None else found.name) == name


def test_a_kind_of_a_movement_is_no_evidence() -> None:
    signs = movement_signs(body_track(motion_of(walking(turn=0.5))))[None]
    table = evidence(("jog", "turn", "zebra"), signs)
    np.testing.assert_array_equal(np.isnan(table), [[True, False, True]])
    assert table[0, 1] > 0.9


@pytest.mark.parametrize(
    ("word", "part"), [("ankles", "foot"), ("wrist", "hand"), ("heads", "head"), ("walk", None)]
)
def test_parts_of_the_body_are_known(word: str, part: str | None) -> None:
    assert body_part(word) == part


def test_every_part_and_side_has_its_detector() -> None:
    for part in ("hand", "knee", "foot", "leg", "arm", "elbow", "head", "trunk"):
        for side in (None, "left", "right", "both"):
            assert body_detector(part, side) in DETECTORS
    assert [body_side(word) for word in ("left", "two", "walk")] == ["left", "both", None]
    assert body_detector(None, body_side("two")) in DETECTORS
