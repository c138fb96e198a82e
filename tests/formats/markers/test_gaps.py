"""Long gaps are filled by neighbors, or a whole stretch is read, or roles are left out."""

from __future__ import annotations

import numpy as np
import pytest

from app.errors import Unreadable
from app.formats.c3d.reader import read_c3d
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.formats.c3d.files import c3d, marker_person, stacked
from tests.people import ROLES

R = JointRole
FRAMES = 400
TRACKS, TRUTH = marker_person(frames=FRAMES)
MARKERS, LABELS = stacked(TRACKS)
LEFT_LEG = ("LKNE", "LKNM", "LTHI", "LANK", "LANM", "LHEE", "LTOE")
LEFT_ARM = ("LWRA", "LWRB", "LELB", "LELM", "LUPA")


def hidden(*gaps: tuple[str, int, int]) -> FloatArray:
    positions = MARKERS.copy()
    for label, start, end in gaps:
        positions[start:end, LABELS.index(label)] = np.nan
    return positions


def read(*gaps: tuple[str, int, int]) -> Recording:
    return read_c3d(c3d(hidden(*gaps), LABELS, first=101))


def errors(motion: Motion, start: int = 0) -> dict[JointRole, float]:
    """The largest distance of each role from its true position, in meters."""
    truth = TRUTH[start : start + motion.frames, [ROLES.index(role) for role in SUN_ROLES]]
    apart = np.linalg.norm(motion.role_positions() - truth, axis=-1).max(axis=0)
    return {r: e for r, e in zip(SUN_ROLES, apart.tolist(), strict=True) if r in motion.roles}


@pytest.mark.parametrize("start", [0, 100, 200])
def test_a_marker_of_a_rigid_group_is_filled_for_seconds(start: int) -> None:
    recording = read(("LFHD", start, start + 200), ("RPSI", start, start + 200))
    assert [c.code for c in recording.cautions] == ["gaps_filled"]
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert max(errors(motion).values()) < 0.01
    joint = recording.skeleton.names.index("LFHD")
    apart = recording.positions[:, joint] - MARKERS[:, LABELS.index("LFHD")]
    assert np.linalg.norm(apart, axis=-1).max() < 20  # millimeters


def test_a_gap_just_over_the_limit_of_splines_is_filled() -> None:
    recording = read(("LKNE", 200, 228), ("LWRA", 10, 40))
    (caution,) = recording.cautions
    assert (caution.code, caution.frames, caution.joint) == ("gaps_filled", (10, 40), "LWRA")
    assert "frames 111 to 140" in caution.detail  # the file's own numbers begin at 101
    assert max(errors(canonicalize(recording)).values()) < 0.02


@pytest.mark.parametrize(("start", "end", "first"), [(0, 100, 100), (300, 400, 0)])
def test_the_longest_whole_stretch_is_read(start: int, end: int, first: int) -> None:
    recording = read(*((label, start, end) for label in LEFT_LEG))
    (caution,) = (c for c in recording.cautions if c.code == "frames_trimmed")
    count = FRAMES - (end - start)
    assert len(recording.positions) == count
    assert f"frames {101 + first} to {100 + first + count}" in caution.detail
    assert f"{count} of {FRAMES} frames" in caution.detail
    assert canonicalize(recording).start_offset == first / 100
    assert canonicalize(recording, frame_rate=50).start_offset == first / 50
    assert max(errors(canonicalize(recording), first).values()) < 0.001


def test_roles_that_can_be_spared_are_left_out() -> None:
    recording = read(*((label, 100, 300) for label in LEFT_ARM))
    assert [c.code for c in recording.cautions] == ["markers_left_out"]
    motion = canonicalize(recording)
    assert motion.frames == FRAMES
    assert set(motion.missing_roles) == {R.LEFT_ELBOW, R.LEFT_HAND}
    assert max(errors(motion).values()) < 0.001


def test_a_knee_is_not_spared() -> None:
    recording = read(*((label, 130, 270) for label in LEFT_LEG))
    assert len(recording.positions) == 130
    assert canonicalize(recording).missing_roles == ()


def test_markers_without_a_stretch_of_half_a_second_are_named() -> None:
    gaps = [(label, start, start + 80) for label in LEFT_LEG for start in range(30, 400, 110)]
    with pytest.raises(Unreadable) as caught:
        read(*gaps)
    locations = [place.location for place in caught.value.places]
    assert "marker LKNE, frames 131 to 210" in locations


def test_a_gap_of_a_single_marker_between_distant_ones_is_not_guessed() -> None:
    rng = np.random.default_rng(0)
    wild = MARKERS.copy()
    wild[:, LABELS.index("LTHI")] = np.cumsum(rng.normal(scale=30, size=(FRAMES, 3)), axis=0)
    wild[100:300, LABELS.index("LTHI")] = np.nan
    recording = read_c3d(c3d(wild, LABELS))
    assert [c.code for c in recording.cautions] == ["markers_left_out"]
    assert "LTHI" not in recording.skeleton.names


@pytest.mark.parametrize("number", [9999.99, -9999.0, 99999.0])
def test_numbers_that_stand_for_hidden_markers(number: float) -> None:
    positions = MARKERS.copy()
    positions[50:60, LABELS.index("LKNE")] = number
    recording = read_c3d(c3d(positions, LABELS))
    assert [c.code for c in recording.cautions] == ["gaps_filled"]
    assert max(errors(canonicalize(recording)).values()) < 0.01
