"""Vectors of segments: similar segments of all dancers are near, others are not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.analysis.segments.segments import (
    SAMPLES,
    SEGMENT_WIDTH,
    describe_segments,
    segment_spans,
    segment_vectors,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, waving
from tests.cyclic_dances import CyclicDance, cyclic_dance


def _features(positions: FloatArray, rate: float = 30.0) -> FloatArray:
    track = body_track(motion_of(positions, rate))
    return features_at_10hz(frame_features(track), track.rate)


def _vectors(dance: CyclicDance) -> tuple[FloatArray, list[tuple[int, int]]]:
    spans = segment_spans(dance.stops)
    labels = list(zip(dance.labels[:-1], dance.labels[1:], strict=True))
    return segment_vectors(_features(dance.positions, dance.rate), spans), labels


def test_the_same_step_of_another_dancer_and_time_is_nearest() -> None:
    one, one_labels = _vectors(cyclic_dance(300, poses=8, times=2, change=0.3, dancer=1))
    other, labels = _vectors(cyclic_dance(300, poses=8, times=2, change=0.3, dancer=2, tempo=110))
    right = total = 0
    for vector, label in zip(one, one_labels, strict=True):
        if -1 in label or label not in labels:
            continue
        nearest = int(np.argmin(np.linalg.norm(other - vector, axis=1)))
        right += labels[nearest] == label
        total += 1
    assert total == 15
    assert right >= 14


def test_a_step_differs_from_its_reverse() -> None:
    there = waving(2.0, hz=0.125)  # sideways once
    back = there[::-1]
    same, reverse = (segment_vectors(_features(b), np.array([[0.2, 1.8]])) for b in (there, back))
    shifted = segment_vectors(_features(np.roll(there, 1, axis=0)), np.array([[0.233, 1.833]]))
    assert np.linalg.norm(same - reverse) > 5 * np.linalg.norm(same - shifted)


@settings(max_examples=10, deadline=None)
@given(st.floats(0.5, 2.0), st.floats(-3.0, 3.0), st.tuples(*[st.floats(-5.0, 5.0)] * 2))
def test_size_heading_and_position_do_not_matter(
    size: float, angle: float, place: tuple[float, float]
) -> None:
    dance = cyclic_dance(310, poses=3, times=1, noise=0.0)
    moved = size * turned_about_y(dance.positions, angle) + np.array([place[0], 0.0, place[1]])
    spans = segment_spans(dance.stops)
    one, other = (segment_vectors(_features(p, 60.0), spans) for p in (dance.positions, moved))
    assert np.abs(one - other).max() < 2e-3


def test_distances_are_those_of_the_joints() -> None:
    body = standing(60)
    raised = body.copy()
    raised[:, 11] += [0.0, 0.3, 0.0]
    span = np.array([[0.0, 1.9]])
    apart = np.linalg.norm(
        segment_vectors(_features(body), span) - segment_vectors(_features(raised), span)
    )
    assert apart == pytest.approx(0.3 / body_track(motion_of(body)).body_length, rel=1e-3)


def test_arrays_have_one_length_and_cycles_are_within_it() -> None:
    dance = cyclic_dance(320, poses=5, times=4)
    arrays = describe_segments(_features(dance.positions, dance.rate), dance.stops)
    count = len(dance.stops) - 1
    assert arrays["segment_spans"].shape == (count, 2)
    assert arrays["segment_vectors"].shape == (count, SEGMENT_WIDTH)
    assert arrays["segment_cycles"].shape[0] >= 3
    assert arrays["segment_cycles"][:, :2].max() <= count
    np.testing.assert_allclose(arrays["segment_spans"][1:, 0], arrays["segment_spans"][:-1, 1])


@pytest.mark.parametrize("keyposes", [[], [0.5]])
def test_fewer_than_two_keyposes_give_no_segment(keyposes: list[float]) -> None:
    arrays = describe_segments(_features(standing(30)), np.array(keyposes))
    assert {name: array.shape for name, array in arrays.items()} == {
        "segment_spans": (0, 2), "segment_vectors": (0, SEGMENT_WIDTH), "segment_cycles": (0, 3),
    }  # fmt: skip


def test_times_outside_the_clip_use_its_ends() -> None:
    features = _features(standing(3))
    arrays = describe_segments(features, np.array([0.0, 0.03, 0.06, 4.0]))
    assert all(np.isfinite(array).all() for array in arrays.values())


def test_there_are_samples_at_both_keyposes() -> None:
    features = _features(cyclic_dance(330, poses=2, times=1).positions, 60.0)
    vector = segment_vectors(features, np.array([[0.5, 1.5]]))[0]
    first = np.delete(features[5, :39].reshape(13, 3), 4, axis=0).ravel()
    np.testing.assert_allclose(vector[:36] * np.sqrt(SAMPLES), first, atol=1e-5)
