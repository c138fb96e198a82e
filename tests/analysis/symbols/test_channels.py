from __future__ import annotations

import numpy as np
import pytest

from app.analysis.symbols.channels import CHANNELS, symbol_features, symbol_statistics
from app.motion.frame.body_frame import body_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from tests.bodies import motion_of, move_joint, standing, turned_about_y, walking, waving


def features_of(positions: np.ndarray, frame_rate: float = 30.0) -> np.ndarray:
    return symbol_features(body_track(motion_of(positions, frame_rate)))


def channel(features: np.ndarray, name: str) -> np.ndarray:
    return features[:, CHANNELS.index(name)]


@pytest.mark.parametrize(
    "changed",
    [
        lambda body: body + np.array([5.0, 0.7, -3.0]),
        lambda body: turned_about_y(body, 2.0),
        lambda body: body * 1.6,
    ],
    ids=["place", "heading", "size"],
)
def test_position_heading_and_size_do_not_matter(changed) -> None:  # type: ignore[no-untyped-def]
    body = walking()
    np.testing.assert_allclose(features_of(changed(body)), features_of(body), atol=2e-3)


def test_the_frame_rate_hardly_matters() -> None:
    slow = symbol_statistics(features_of(walking(rate=30.0)), 30.0)
    fast = symbol_statistics(features_of(walking(rate=120.0), 120.0), 30.0)
    np.testing.assert_allclose(fast, slow, atol=0.1)


def test_the_mirrored_body_has_mirrored_channels() -> None:
    body = waving()
    mirrored = body[:, [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]] * [-1, 1, 1]
    there, back = features_of(body), features_of(mirrored)
    for name in CHANNELS[:18]:
        side, rest = name.split("_", 1)
        other = channel(back, {"left": "right_", "right": "left_"}[side] + rest)
        sign = -1.0 if rest.endswith("left") else 1.0
        np.testing.assert_allclose(other * sign, channel(there, name), atol=1e-4)


def test_channels_agree_with_their_names() -> None:
    walk, wave = features_of(walking(speed=1.2)), features_of(waving())
    assert channel(walk, "speed_forward").mean() > 0.5
    assert abs(channel(walk, "speed_left").mean()) < 0.2
    assert channel(wave, "right_forearm_up").mean() > 1.0
    assert channel(wave, "left_forearm_up").mean() < -1.0
    assert channel(features_of(walking(turn=0.8)), "yaw_rate").mean() == pytest.approx(
        0.8 / 1.3, abs=0.1
    )
    assert channel(wave, "height").mean() > 5.0


def test_channels_of_a_circling_arm_do_not_jump() -> None:
    body = standing(90)
    angle = np.linspace(0, 4 * np.pi, 90)
    circle = np.stack([0 * angle, 0.28 - 0.28 * np.cos(angle), 0.28 * np.sin(angle)], axis=1)
    move_joint(body, JointRole.LEFT_ELBOW, circle)
    move_joint(body, JointRole.LEFT_HAND, 2 * circle)
    steps = np.abs(np.diff(features_of(body), axis=0))
    assert steps.max() < 0.6


def test_a_body_without_arms_has_still_arm_channels() -> None:
    whole = motion_of(walking())
    arms = ("elbow", "hand")
    kept = {r: i for r, i in whole.roles.items() if not r.value.endswith(arms)}
    motion = Motion(
        "bvh", whole.names, whole.parents, whole.positions, kept,
        tuple(r for r in SUN_ROLES if r not in kept), 30.0, 30.0, 1.0,
    )  # fmt: skip
    features = symbol_features(body_track(motion))
    assert np.isfinite(features).all()
    assert not features[:, 8:18].any()


@pytest.mark.parametrize("frames", [2, 60])
def test_a_still_body_is_described(frames: int) -> None:
    features = features_of(standing(frames))
    statistics = symbol_statistics(features, 30.0)
    assert features.shape == (frames, 26)
    assert statistics.shape == (131,)
    np.testing.assert_allclose(statistics[26:78], 0.0, atol=1e-4)
    assert np.isfinite(symbol_statistics(features[:1], 30.0)).all()
