"""Position, heading, size, unit and frame rate do not change distances, by any method.

The clip itself stays first, and its distances to all others change by less than 1 %.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.analyze import describe_for_search
from app.demo import demo_clips
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.resampling import resample
from app.search.example.methods import Method
from tests.bodies import motion_of, turned_about_y, walking, waving
from tests.real_clips import manifest, real_clips
from tests.search.gallery import Arrays, Gallery, gallery

ALLOWED = 0.01
"""Largest change of a distance, as a share of it."""

ALLOWED_ITSELF = 0.03
"""Largest distance of a clip to itself, as a share of the distance to its nearest neighbor."""

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
REAL_EVERY = 23
"""One real clip in this many is tested."""


@dataclass(frozen=True)
class DemoClips:
    """Motions, the recordings in their files, and the distances between them."""

    recordings: list[Recording]
    motions: list[Motion]
    gallery: Gallery

    @property
    def between(self) -> list[dict[Method, np.ndarray]]:
        return [self.gallery.distances(arrays) for arrays in self.gallery.arrays]


@pytest.fixture(scope="module")
def demo() -> DemoClips:
    clips = list(demo_clips(("ada", "bruno", "chika"), ("walk", "kick", "wave"), takes=1))
    recordings = [read_recording(clip.content) for clip in clips]
    motions = [canonicalize(recording) for recording in recordings]
    persons, tasks = [clip.person for clip in clips], [clip.task for clip in clips]
    return DemoClips(recordings, motions, gallery(motions, persons, tasks))


@pytest.fixture(scope="module")
def distances(demo: DemoClips) -> list[dict[Method, np.ndarray]]:
    return demo.between


def assert_nothing_changed(
    known: Gallery, which: int, before: dict[Method, np.ndarray], changed: Arrays
) -> None:
    """By every method."""
    after = known.distances(changed)
    others = np.arange(len(known.arrays)) != which
    for method, were in before.items():
        now = after[method]
        assert np.argmin(now) == which, method
        assert now[which] <= ALLOWED_ITSELF * were[others].min() + 1e-6, (method, now[which])
        change = np.abs(now - were)[others] / were[others]
        assert change.max() < ALLOWED, (method, change.max())


def test_every_method_is_tested(distances: list[dict[Method, np.ndarray]]) -> None:
    assert set(distances[0]) == set(Method)


@given(
    which=st.integers(0, 8),
    angle=st.floats(-np.pi, np.pi),
    place=st.tuples(st.floats(-80, 80), st.floats(-2, 2), st.floats(-80, 80)),
    scale=st.floats(0.4, 2.5),
)
@settings(max_examples=25, deadline=None)
def test_position_heading_and_size_do_not_matter(
    demo: DemoClips,
    distances: list[dict[Method, np.ndarray]],
    which: int,
    angle: float,
    place: tuple[float, float, float],
    scale: float,
) -> None:
    motion = demo.motions[which]
    moved = scale * turned_about_y(motion.positions.astype(float), angle) + np.array(place)
    changed = describe_for_search(replace(motion, positions=moved.astype(np.float32))).arrays
    assert_nothing_changed(demo.gallery, which, distances[which], changed)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("is_said", [True, False])
def test_a_declared_or_guessed_unit_does_not_matter(
    demo: DemoClips, distances: list[dict[Method, np.ndarray]], unit: str, is_said: bool
) -> None:
    for which in range(0, 9, 2):
        recording = demo.recordings[which]
        metres = demo.motions[which].metres_per_unit
        positions = recording.positions * np.float32(metres / UNITS[unit])
        offsets = recording.skeleton.offsets * (metres / UNITS[unit])
        told = replace(
            recording,
            positions=positions,
            skeleton=replace(recording.skeleton, offsets=offsets),
            metres_per_unit=None,
        )
        motion = canonicalize(told, metres_per_unit=UNITS[unit] if is_said else None)
        changed = describe_for_search(motion).arrays
        assert_nothing_changed(demo.gallery, which, distances[which], changed)


@given(which=st.integers(0, 8), rate=st.sampled_from([60.0, 90.0, 120.0, 240.0]))
@settings(max_examples=12, deadline=None)
def test_a_higher_frame_rate_does_not_matter(
    demo: DemoClips, distances: list[dict[Method, np.ndarray]], which: int, rate: float
) -> None:
    changed = describe_for_search(resampled(demo.motions[which], rate)).arrays
    assert_nothing_changed(demo.gallery, which, distances[which], changed)


@pytest.mark.parametrize("rate", [60.0, 120.0])
def test_the_same_movement_recorded_at_another_rate_is_the_same(rate: float) -> None:
    """Not read between frames but known at any time."""

    def recorded(rate: float) -> list[Motion]:
        walks = [walking(4.0, rate, steps_hz=hz, arm=arm) for hz, arm in ((0.8, 0.2), (1.0, 0.4))]
        waves = [waving(4.0, rate, hz=hz) for hz in (1.1, 1.6)]
        return [motion_of(body, rate) for body in walks + waves]

    known = gallery(recorded(30.0), ["a", "b", "a", "b"], ["walk", "walk", "wave", "wave"])
    for which, motion in enumerate(recorded(rate)):
        before = known.distances(known.arrays[which])
        assert_nothing_changed(known, which, before, describe_for_search(motion).arrays)


@pytest.mark.slow
def test_real_clips_do_not_change_either() -> None:
    rows = [row for row in manifest() if row["path"].endswith(".bvh")][::REAL_EVERY]
    motions = [
        canonicalize(
            read_recording((real_clips() / row["path"]).read_bytes()), frame_rate=float(row["fps"])
        )
        for row in rows
    ]
    known = gallery(motions, [row["person"] for row in rows], [row["task"] for row in rows])
    for which, motion in enumerate(motions):
        before = known.distances(known.arrays[which])
        turned = turned_about_y(motion.positions.astype(float), 2.0 + which)
        moved = replace(motion, positions=(1.7 * turned + [9.0, 0.3, -4.0]).astype(np.float32))
        assert_nothing_changed(known, which, before, describe_for_search(moved).arrays)
        for rate in (30.0, 60.0, 120.0):
            again = describe_for_search(resampled(motion, rate)).arrays
            assert_nothing_changed(known, which, before, again)


def resampled(motion: Motion, rate: float) -> Motion:
    positions = resample(motion.positions, motion.frame_rate, rate)
    return replace(motion, positions=positions, frame_rate=rate)
