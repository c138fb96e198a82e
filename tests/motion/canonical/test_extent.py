"""Positions beyond human limits are refused, with joint and frame, in any unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.analyze import analyze
from app.errors import BadContent
from app.motion.canonical.canonical import canonicalize
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray
from tests.people import CONVENTIONS, ROLES, person

HIPS, HAND = ROLES.index("hips"), ROLES.index("left_hand")


def moved(
    change: FloatArray | float, frames: object = slice(None), joint: int | None = None
) -> Recording:
    """A person in meters whose positions are changed in some frames."""
    recording = person(CONVENTIONS["DAZ"])
    positions = recording.positions.copy()
    positions[frames, slice(None) if joint is None else joint] += np.asarray(change, np.float32)
    return replace(recording, positions=positions)


@pytest.mark.parametrize(
    ("recording", "location", "found"),
    [
        (moved(20.0, 7, HAND), "frame 7, joint lHand", "from the hips"),
        (moved(1e9, 3, HAND), "frame 3, joint lHand", "from the origin"),
        (moved(1e9), "frame 0, joint hip", "1e+09 m"),
        (moved(-2e4), "frame 0, joint hip", "from the origin"),
        (moved(200.0, slice(12, None)), "frame 12, joint hip", "before"),
    ],
    ids=["hand", "far hand", "all far", "all far the other way", "jump"],
)
def test_a_body_beyond_human_limits_is_refused(
    recording: Recording, location: str, found: str
) -> None:
    with pytest.raises(BadContent) as caught:
        canonicalize(recording, metres_per_unit=1.0)
    (place,) = caught.value.places
    assert place.location == location
    assert found in place.message


def test_the_unit_of_a_client_is_checked_by_the_size_of_the_body() -> None:
    canonicalize(person(scale=100.0), metres_per_unit=0.01)
    with pytest.raises(BadContent, match="Is the unit right"):
        canonicalize(person(scale=1000.0), metres_per_unit=1.0)
    # A very small body may not travel further, by its own length, than a large one.
    with pytest.raises(BadContent, match="before"):
        canonicalize(moved(2000.0, slice(12, None)), metres_per_unit=1e-3)


def test_a_walk_far_from_the_origin_and_a_cut_are_accepted() -> None:
    assert canonicalize(moved(4_000.0), metres_per_unit=1.0).cautions == ()
    canonicalize(moved(30.0, slice(12, None)), metres_per_unit=1.0)


def test_a_far_joint_outside_the_body_only_gives_a_caution() -> None:
    plain = person(CONVENTIONS["DAZ"])
    skeleton = Skeleton(
        names=(*plain.skeleton.names, "camera"),
        parents=np.append(plain.skeleton.parents, -1),
        offsets=np.vstack([plain.skeleton.offsets, np.zeros(3)]),
    )
    camera = np.full((len(plain.positions), 1, 3), 1e8, np.float32)
    positions = np.concatenate([plain.positions, camera], axis=1)
    motion = canonicalize(replace(plain, skeleton=skeleton, positions=positions))
    (doubt,) = [caution for caution in motion.cautions if caution.code == "position_suspect"]
    assert "frame 0, joint camera" in doubt.detail
    assert (doubt.frames, doubt.joint) == ((0, 1), "camera")
    _check_arrays(analyze(motion).arrays)


def _check_arrays(arrays: dict[str, FloatArray]) -> None:
    for name, array in arrays.items():
        assert np.isfinite(array).all(), name


MAGNITUDES = st.floats(-9, 12).map(lambda power: 10.0**power)


@settings(max_examples=150, deadline=None, derandomize=True, database=None)
@given(
    unit=st.none() | st.floats(-6, 3).map(lambda power: 10.0**power),
    rate=st.sampled_from([1.0, 24.0, 30.0, 120.0, 2000.0]),
    stretch=st.sampled_from([1e-6, 1e-3, 1.0, 1e3, 1e6]),
    far=MAGNITUDES,
    frame=st.integers(0, 39),
    until=st.integers(1, 40),
    joint=st.none() | st.integers(0, len(ROLES) - 1),
)
def test_every_accepted_motion_can_be_described(
    unit: float | None,
    rate: float,
    stretch: float,
    far: float,
    frame: int,
    until: int,
    joint: int | None,
) -> None:
    # An overflow in the conversion to float16 would give a warning, which is an error here.
    plain = moved(min(far, 1e9), slice(frame, frame + until), joint)
    positions = np.clip(plain.positions * np.float32(stretch), -1e9, 1e9)
    try:
        motion = canonicalize(
            replace(plain, positions=positions), metres_per_unit=unit, frame_rate=rate
        )
        found = analyze(motion)
    except BadContent:
        return
    _check_arrays(found.arrays)
