"""The actors stand on the floor, fall freely, and bend their joints to the right side."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from app.demo import DemoClip
from app.demo.actors import ACTORS
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole as Role

LEFT_HANDED = {actor.name for actor in ACTORS if actor.left_handed}
BOTH = ("left", "right")


@pytest.fixture
def clip(clips: dict[tuple[str, str], DemoClip], person: str, task: str) -> DemoClip:
    return clips[person, task]


@pytest.fixture
def motion(motions: dict[tuple[str, str], Motion], person: str, task: str) -> Motion:
    return motions[person, task]


def clips_of(*tasks: str) -> pytest.MarkDecorator:
    chosen = [(actor.name, task) for actor in ACTORS for task in tasks]
    return pytest.mark.parametrize(("person", "task"), chosen)


def place(motion: Motion, role: str) -> np.ndarray:
    """(frames, 3) meters."""
    return motion.positions[:, motion.roles[Role(role)]].astype(np.float64)


def runs(mask: np.ndarray) -> list[np.ndarray]:
    """The frames of each run in which `mask` (frames,) is true."""
    frames = np.flatnonzero(mask)
    return [part for part in np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1) if len(part)]


def bend(motion: Motion, upper: str, middle: str, lower: str) -> tuple[np.ndarray, np.ndarray]:
    """The angle (frames,) between two links in radians, and the axis (frames, 3) of the bend."""
    first = place(motion, middle) - place(motion, upper)
    second = place(motion, lower) - place(motion, middle)
    axis = np.cross(first, second)
    return np.arctan2(np.linalg.norm(axis, axis=1), np.sum(first * second, axis=1)), axis


@clips_of("walk", "run", "jump", "wave", "kick", "punch", "bow", "dance")
def test_no_foot_goes_below_the_floor(motion: Motion) -> None:
    feet = [place(motion, f"{s}_{part}")[:, 1] for s in BOTH for part in ("foot", "toes")]
    assert np.min(feet) > -0.01


@clips_of("walk", "run")
def test_a_standing_foot_does_not_slide(motion: Motion) -> None:
    for side in BOTH:
        ball = place(motion, f"{side}_toes")
        standing = runs(ball[:, 1] < ball[:, 1].min() + 0.005)
        assert len(standing) >= 3
        for frames in standing:
            assert np.max(np.ptp(ball[frames][:, [0, 2]], axis=0)) < 0.02


@clips_of("wave", "bow", "kick", "punch")
def test_the_standing_foot_does_not_move(motion: Motion, person: str) -> None:
    side = "right" if person in LEFT_HANDED else "left"
    ball = place(motion, f"{side}_toes")
    assert np.max(np.ptp(ball, axis=0)) < 0.01


@clips_of("walk", "run", "jump", "wave", "kick", "punch", "bow", "dance")
def test_knees_and_elbows_bend_the_right_way(motion: Motion, task: str) -> None:
    left = place(motion, "left_upper_leg") - place(motion, "right_upper_leg")
    up = place(motion, "neck") - place(motion, "hips")
    for side in BOTH:
        angle, axis = bend(motion, f"{side}_upper_leg", f"{side}_knee", f"{side}_foot")
        assert np.all(np.sum(axis * left, axis=1)[angle > np.radians(5)] > 0.0)
        assert np.max(angle) < np.radians(150)
        angle, axis = bend(motion, f"{side}_shoulder", f"{side}_elbow", f"{side}_hand")
        assert np.max(angle) < np.radians(150)
        # The arm at ease: elbows bend forward.
        down = np.sum(
            (place(motion, f"{side}_elbow") - place(motion, f"{side}_shoulder")) * up, axis=1
        )
        hanging = (down < -0.9 * 0.17 * np.linalg.norm(up, axis=1)) & (angle > np.radians(10))
        if task in {"walk", "wave", "bow"}:
            assert np.all(np.sum(axis * left, axis=1)[hanging] < 0.0)


@clips_of("jump")
def test_flight_is_free_fall(motion: Motion) -> None:
    toes = np.minimum(place(motion, "left_toes")[:, 1], place(motion, "right_toes")[:, 1])
    flights = runs(toes > toes[0] + 0.04)
    assert len(flights) == 2
    for frames in flights:
        height = place(motion, "hips")[frames, 1]
        seconds = frames / motion.frame_rate
        assert -2.0 * np.polyfit(seconds - seconds[0], height, 2)[0] == pytest.approx(
            9.81, rel=0.04
        )


@clips_of("jump")
def test_the_body_crouches_before_and_after_a_jump(motion: Motion) -> None:
    height = place(motion, "hips")[:, 1]
    apex = int(np.argmax(height))
    assert np.min(height[:apex]) < 0.85 * height[0]
    assert np.min(height[apex:]) < 0.9 * height[0]
    assert height[apex] > 1.1 * height[0]


@clips_of("walk", "run")
def test_a_walker_always_has_a_foot_down_and_a_runner_does_not(motion: Motion, task: str) -> None:
    toes = np.minimum(place(motion, "left_toes")[:, 1], place(motion, "right_toes")[:, 1])
    aloft = np.mean(toes > toes.min() + 0.012)
    if task == "walk":
        assert aloft < 0.12  # on the heel alone the ball is up for a moment
    else:
        assert aloft > 0.15


@clips_of("walk", "run")
def test_steps_have_a_plausible_duration(motion: Motion, task: str) -> None:
    ahead = place(motion, "left_foot") - place(motion, "right_foot")
    hips = place(motion, "hips")
    forward = hips[-1] - hips[0]
    apart = ahead @ forward
    strides = np.diff(np.flatnonzero((apart[:-1] < 0) & (apart[1:] >= 0))) / motion.frame_rate
    lowest, highest = (0.85, 1.5) if task == "walk" else (0.55, 1.0)
    assert len(strides) >= 2
    assert np.all((strides > lowest) & (strides < highest))


@clips_of("walk", "run")
def test_arms_swing_against_the_legs(motion: Motion) -> None:
    hips = place(motion, "hips")
    forward = hips[-1] - hips[0]
    hands = (place(motion, "left_hand") - place(motion, "right_hand")) @ forward
    feet = (place(motion, "left_foot") - place(motion, "right_foot")) @ forward
    assert np.corrcoef(hands, feet)[0, 1] < -0.7


@clips_of("wave", "kick")
def test_the_stronger_side_performs_the_task(
    clip: DemoClip, motion: Motion, person: str, task: str
) -> None:
    part = "hand" if task == "wave" else "foot"
    strong, weak = BOTH if person in LEFT_HANDED else BOTH[::-1]
    strong_top, weak_top = (np.max(place(motion, f"{s}_{part}")[:, 1]) for s in (strong, weak))
    assert strong_top > weak_top + 0.25
    assert f"{strong}_{'hand' if part == 'hand' else 'leg'}" in clip.words


@clips_of("bow")
def test_a_bow_brings_the_head_down_and_up_again(motion: Motion) -> None:
    head = place(motion, "head")[:, 1]
    assert np.min(head) < 0.86 * head[0]
    assert head[-1] == pytest.approx(head[0], rel=0.02)


@clips_of("dance")
def test_a_dancer_rests_at_keyposes(clip: DemoClip, motion: Motion) -> None:
    speed = np.linalg.norm(np.diff(motion.positions, axis=0), axis=-1).mean(axis=1)
    speed *= motion.frame_rate
    for here, after in pairwise(clip.keyposes):
        held = speed[round(here * motion.frame_rate)]
        moved = speed[round(here * motion.frame_rate) : round(after * motion.frame_rate)]
        assert held < 0.25 * np.max(moved)
