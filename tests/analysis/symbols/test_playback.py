"""A symbol generates the motion to which it was fitted, except for averaging within states."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.symbols.channels import CHANNEL_SCALES, CHANNELS, symbol_features
from app.analysis.symbols.playback import SymbolMotion, symbol_motion
from app.analysis.symbols.symbol import motion_symbol
from app.motion.frame.body_frame import BodyTrack, body_track
from app.motion.roles.joint_roles import SUN_PARENTS
from tests.bodies import motion_of, walking

HIPS = 4
"""In SUN_ROLES."""


@pytest.fixture(scope="module")
def track() -> BodyTrack:
    return body_track(motion_of(walking()))


@pytest.fixture(scope="module")
def made(track: BodyTrack) -> SymbolMotion:
    return symbol_motion(motion_symbol(symbol_features(track)), track)


def _bones(positions: np.ndarray) -> np.ndarray:
    children = [joint for joint, parent in enumerate(SUN_PARENTS) if parent >= 0]
    parents = [SUN_PARENTS[joint] for joint in children]
    return np.linalg.norm(positions[:, children] - positions[:, parents], axis=-1)


def test_duration_and_travel_agree_with_the_clip(track: BodyTrack, made: SymbolMotion) -> None:
    assert len(made.positions) == pytest.approx(track.frames, rel=0.05)
    assert len(made.means) == len(made.spreads) == len(made.positions)
    way = np.linalg.norm((made.positions[-1, HIPS] - made.positions[0, HIPS])[[0, 2]])
    walked = np.linalg.norm((track.origin[-1] - track.origin[0])[[0, 2]])
    assert walked > 0.5
    assert way == pytest.approx(walked, rel=0.1)


def test_poses_agree_with_the_clip_except_for_averaging(
    track: BodyTrack, made: SymbolMotion
) -> None:
    generated = body_track(motion_of(made.positions)).local
    then = np.linspace(0, track.frames - 1, len(generated)).round().astype(int)
    error = np.linalg.norm(generated - track.local[then], axis=-1).mean()
    sway = np.linalg.norm(track.local - track.local.mean(axis=0), axis=-1).mean()
    assert error < 0.4 * sway


def test_limbs_keep_their_lengths(track: BodyTrack, made: SymbolMotion) -> None:
    expected = np.median(_bones(track.local), axis=0) * track.body_length
    assert np.allclose(_bones(made.positions), expected)


def test_the_channels_are_those_of_the_generated_motion(made: SymbolMotion) -> None:
    seen = symbol_features(body_track(motion_of(made.positions))) * CHANNEL_SCALES
    for name in ("left_knee_flexion", "left_thigh_forward", "height"):
        channel = CHANNELS.index(name)
        assert np.corrcoef(seen[:, channel], made.means[:, channel])[0, 1] > 0.8, name
    forward = CHANNELS.index("speed_forward")
    assert seen[:, forward].mean() == pytest.approx(made.means[:, forward].mean(), rel=0.02)
    assert (made.spreads > 0).all()


def test_a_symbol_of_one_state_holds_a_pose(track: BodyTrack) -> None:
    short = track.part(0, 4)
    made = symbol_motion(motion_symbol(symbol_features(short)), short)
    local = made.positions - made.positions[:, HIPS : HIPS + 1]
    assert np.isfinite(local).all()
    assert np.allclose(np.linalg.norm(local, axis=-1), np.linalg.norm(local[0], axis=-1))
