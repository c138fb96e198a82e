"""Joints that differ between two motions are found at the moment at which they differ."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.alignment import MIN_SECONDS_APART, align, peaks
from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from app.search.example.distances import ACTIVE, FEATURES, distances_to
from app.search.example.methods import Method
from tests.bodies import motion_of, move_joint, standing, turned_about_y, walking, waving

HAND = SUN_ROLES.index(JointRole.RIGHT_HAND)


def features_of(body: FloatArray, rate: float = 30.0) -> FloatArray:
    return features_at_10hz(frame_features(body_track(motion_of(body, rate))), 30.0)


def test_the_distance_is_that_of_the_method_dtw() -> None:
    one, other = features_of(walking()), features_of(waving(3.0))
    whole = np.array([0.0, 1e3])
    query, stored = {FEATURES: one, ACTIVE: whole}, {FEATURES: other, ACTIVE: whole}
    (found,) = distances_to(query, ["b"], Method.DTW, lambda ids, name: {"b": stored[name]})
    assert align(one, other).distance == pytest.approx(found, rel=1e-5)


def test_differences_are_distances_of_the_joints_of_both_bodies() -> None:
    one, other = features_of(walking()), features_of(waving(3.0))
    found = align(one, other)
    for step in range(0, len(found.times), 7):
        i, j = np.round(found.times[step] * 10).astype(int)
        for joint in range(13):
            columns = slice(3 * joint, 3 * joint + 3)
            by_hand = float(np.sqrt(((one[i, columns] - other[j, columns]) ** 2).sum()))
            assert found.differences[step, joint] == pytest.approx(by_hand, abs=1e-6)


def test_place_heading_and_size_make_no_difference() -> None:
    body = walking()
    moved = turned_about_y(body, 2.0) * 1.3 + [3.0, 0.5, -4.0]
    found = align(features_of(body), features_of(moved))
    assert found.distance < 1e-3
    assert found.differences.max() < 1e-3


def test_a_slower_motion_takes_more_time_on_the_same_path() -> None:
    fast, slow = features_of(waving(3.0, hz=1.5)), features_of(waving(4.5, hz=1.0))
    found = align(fast, slow)
    middle = found.times[len(found.times) // 2]
    assert middle[1] == pytest.approx(1.5 * middle[0], abs=0.35)
    assert (np.diff(found.times.mean(axis=1)) > 0).all()


def test_a_raised_hand_differs_alone_and_at_its_time() -> None:
    body, raised = standing(120), standing(120)
    lift = np.zeros((120, 3))
    lift[60:75, 1] = 0.4
    move_joint(raised, JointRole.RIGHT_HAND, lift)
    found = align(features_of(body), features_of(raised))
    others = [joint for joint in range(13) if joint != HAND]
    assert found.differences[:, others].max() < 0.01
    (first, *_) = peaks(found, 3)
    assert 1.9 <= found.times[first, 1] <= 2.6
    size = body_track(motion_of(body)).body_length
    assert found.differences[first, HAND] * size == pytest.approx(0.4, abs=0.05)


def test_peaks_are_apart_and_the_greatest_comes_first() -> None:
    found = align(features_of(walking()), features_of(waving(3.0)))
    steps = peaks(found, 5)
    means = found.differences.mean(axis=1)
    assert means[steps[0]] == means.max()
    assert (np.diff(means[steps]) <= 0).all()
    moments = np.sort(found.times.mean(axis=1)[steps])
    assert (np.diff(moments) >= MIN_SECONDS_APART - 1e-9).all()
