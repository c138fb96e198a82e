"""Motions of which one is a part of the other, and motions that have nothing in common."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.analysis.analyze import describe_for_search
from app.motion.motion import Motion
from app.search.example.containment import containment
from app.search.example.distances import ACTIVE, FEATURES
from app.search.example.fusion import CONTAINED
from tests.bodies import motion_of, standing, walking, waving


def _described(motion: Motion) -> dict[str, np.ndarray]:
    return dict(describe_for_search(motion, (FEATURES, ACTIVE)).arrays)


def _part(motion: Motion, first: int, stop: int) -> Motion:
    return replace(motion, positions=motion.positions[first:stop])


def test_tempo_and_crops_are_near_and_other_motions_far() -> None:
    walk = motion_of(walking())
    motions = {
        "same": walk,
        "fast": replace(walk, frame_rate=1.5 * walk.frame_rate),
        "slow": replace(walk, frame_rate=walk.frame_rate / 2),
        "crop": _part(walk, 20, walk.frames - 20),
        "wave": motion_of(waving()),
        "rest": motion_of(standing(60)),
    }
    stored = {name: _described(motion) for name, motion in motions.items()}

    def load(ids: list[str], array: str) -> dict[str, np.ndarray]:
        return {one: stored[one][array] for one in ids if one in stored}

    asked = [*stored, "deleted"]
    found = dict(zip(asked, containment(stored["same"], asked, load).posed, strict=True))
    assert found["same"] == 0.0
    assert max(found[name] for name in ("fast", "slow", "crop")) < CONTAINED / 2
    assert min(found[name] for name in ("wave", "rest")) > CONTAINED
    assert found["deleted"] == np.inf


def test_a_limit_spares_only_distances_from_it_on() -> None:
    walk = motion_of(walking())
    motions = [walk, _part(walk, 20, walk.frames - 20), motion_of(waving())]
    stored = {str(i): _described(motion) for i, motion in enumerate(motions)}

    def load(ids: list[str], array: str) -> dict[str, np.ndarray]:
        return {one: stored[one][array] for one in ids}

    every = containment(stored["1"], list(stored), load).posed
    limited = containment(stored["1"], list(stored), load, CONTAINED).posed
    assert limited[:2].tolist() == every[:2].tolist()
    assert limited[2] == np.inf > every[2] > CONTAINED


def test_another_skeleton_moves_all_poses_and_is_still_the_same_recording() -> None:
    walk = motion_of(walking())
    offsets = 0.12 * np.random.default_rng(3).normal(size=(1, walk.positions.shape[1], 3))
    motions = {
        "same": walk,
        "other skeleton": replace(walk, positions=(walk.positions + offsets).astype(np.float32)),
        "wave": motion_of(waving()),
    }
    stored = {name: _described(motion) for name, motion in motions.items()}

    def load(ids: list[str], array: str) -> dict[str, np.ndarray]:
        return {one: stored[one][array] for one in ids}

    found = containment(stored["same"], list(stored), load)
    posed, moved = (
        dict(zip(stored, one.tolist(), strict=True)) for one in (found.posed, found.moved)
    )
    assert moved["other skeleton"] < posed["other skeleton"] / 2
    assert moved["other skeleton"] < moved["wave"] / 2
    assert found.of_recordings.tolist() == np.minimum(found.posed, found.moved).tolist()
