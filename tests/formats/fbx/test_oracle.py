"""Binary FBX files agree with ufbx, if it is installed: `pip install pufbx` compiles it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.formats.fbx.reader import read_fbx
from app.motion.skeleton.rotations import quaternions_to_matrices
from app.numerics.arrays import FloatArray
from tests.real_clips import real_clips

TOLERANCE = 1e-3
"""Centimeters."""


def keys(found: Any, seconds: FloatArray) -> FloatArray:
    """(n, columns) the values of baked keys at `seconds` (n,), linear between keys."""
    times = np.array([key[0] for key in found])
    values = np.array([list(key[1]) for key in found], dtype=float)
    if values.shape[1] == 4:
        turns = np.sign(np.einsum("ij,ij->i", values[1:], values[:-1]))
        values[1:] *= np.cumprod(np.where(turns < 0, -1, 1))[:, None]
    return np.stack([np.interp(seconds, times, column) for column in values.T], axis=-1)


def baked(file: Path, seconds: FloatArray, rate: float) -> dict[str, FloatArray]:
    """(n, 3) the world positions of each node. No node of these files has a scale."""
    pufbx = pytest.importorskip("pufbx", reason="NO ORACLE: pufbx is not installed")
    from pufbx.animation.bake_anim import bake_anim

    scene = pufbx.load_fbx(str(file))
    animation = bake_anim(scene, scene.anim_stacks[0].anim, resample_rate=rate)
    matrices: dict[int, FloatArray] = {}
    found: dict[str, FloatArray] = {}
    by_id = {node.typed_id: node for node in animation.modified_nodes}
    for node in scene.nodes:
        local = np.tile(np.eye(4), (len(seconds), 1, 1))
        if node.typed_id in by_id:
            turned = keys(by_id[node.typed_id].rotation_keys, seconds)[:, [3, 0, 1, 2]]
            turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
            local[:, :3, :3] = quaternions_to_matrices(turned)
            local[:, :3, 3] = keys(by_id[node.typed_id].translation_keys, seconds)
        above = matrices[node.parent.typed_id] if node.parent is not None else np.eye(4)
        matrices[node.typed_id] = above @ local
        found[node.name] = matrices[node.typed_id][:, :3, 3]
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("name", "first"), [("85_12", 67), ("85_14", 52)])
def test_world_positions_agree_with_ufbx(name: str, first: int) -> None:
    """first: the frame of the clip's first keys, counted from time 0."""
    file = real_clips() / "cmu-fbx" / f"{name}.fbx"
    recording = read_fbx(file.read_bytes())
    assert recording.frame_rate is not None
    seconds = (first + np.arange(len(recording.positions))) / recording.frame_rate
    by_ufbx = baked(file, seconds, recording.frame_rate)
    expected = np.stack([by_ufbx[joint] for joint in recording.skeleton.names], axis=1)
    assert np.abs(recording.positions - expected).max() < TOLERANCE
