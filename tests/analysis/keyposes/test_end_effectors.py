"""Keyposes by hands and feet, the method that Perera compares with."""

from __future__ import annotations

import numpy as np

from app.analysis.keyposes.end_effectors import end_effector_candidates, end_effector_speeds
from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.rhythm.beats import given_beats
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, move_joint, standing, waving
from tests.dances import dance, precision_and_recall


def stops_of(body: FloatArray) -> FloatArray:
    return end_effector_candidates(body_track(motion_of(body)), None).times()


def test_stops_of_hands_and_feet_are_found_with_and_without_beats() -> None:
    made = dance(2, 100, beats=20)
    track = body_track(motion_of(made.positions, made.rate))
    for beats in (given_beats(made.beats), None):
        found = end_effector_candidates(track, beats).times()
        assert min(precision_and_recall(found, made.stops)) > 0.9


def test_feet_that_never_move_are_at_rest() -> None:
    track = body_track(motion_of(waving(6.0, hz=1.0)))
    found = end_effector_candidates(track, None).times() * track.rate
    assert len(found) == 12  # the hand turns round twice in a second
    assert set(np.diff(found).round()) <= {14, 15, 16}


def test_resting_hands_with_walking_feet_make_no_keypose() -> None:
    body = standing(240)
    t = np.arange(240) / 30
    stops = np.clip(np.sin(np.pi * t) * 1.3, -1, 1)[:, None] * [0.0, 0.3, 0.0]
    steps = np.sin(2 * np.pi * 0.5 * t + 1.2)[:, None] * [0.0, 0.0, 0.4]
    for hand in (JointRole.LEFT_HAND, JointRole.RIGHT_HAND):
        move_joint(body, hand, stops)
    assert len(stops_of(body)) == 8
    move_joint(body, JointRole.LEFT_FOOT, steps)
    move_joint(body, JointRole.RIGHT_FOOT, np.roll(steps, 15, axis=0))
    assert len(stops_of(body)) == 0


def test_the_trunk_does_not_count() -> None:
    body = standing(120)
    move_joint(body, JointRole.HEAD, np.sin(np.arange(120) / 8)[:, None] * [0.1, 0.0, 0.0])
    hands, feet = end_effector_speeds(body_track(motion_of(body)))
    assert hands.values.max() < 1e-5
    assert feet.values.max() < 1e-5


def test_noise_harms_this_method_more_than_the_energy() -> None:
    made = dance(7, 90, beats=24, noise=0.025)
    track = body_track(motion_of(made.positions, made.rate))
    theirs = end_effector_candidates(track, given_beats(made.beats)).times()
    ours = find_keyposes(track, beats=made.beats).times
    assert sum(precision_and_recall(ours, made.stops)) > sum(
        precision_and_recall(theirs, made.stops)
    )


def test_a_still_body_has_none() -> None:
    for frames in (2, 90):
        assert len(stops_of(standing(frames))) == 0
