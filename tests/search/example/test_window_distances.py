"""Windows of one second: near for a cut motion, whatever the lengths, and far for other motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.search.example import window_distances as module
from app.search.example.distances import ACTIVE, FEATURES
from app.search.example.window_distances import SCALE, window_distances
from app.search.index.vector_index import VECTOR
from tests.bodies import motion_of, standing, walking, waving

NAMES = (FEATURES, ACTIVE, SCALE.vectors, VECTOR)


class Stored:
    """A walk and a wave, a rest, the first half of the walk, and a clip that has gone."""

    def __init__(self) -> None:
        walk = motion_of(walking())
        motions = {
            "walk": walk,
            "wave": motion_of(waving()),
            "rest": motion_of(standing(60)),
            "half": replace(walk, positions=walk.positions[: walk.frames // 2]),
        }
        self.arrays = {
            name: dict(describe_for_search(motion, NAMES).arrays)
            for name, motion in motions.items()
        }
        self.ids = [*motions, "deleted"]

    def load(self, ids: list[str], array: str) -> dict[str, np.ndarray]:
        return {one: self.arrays[one][array] for one in ids if one in self.arrays}

    def asked(self, query: str) -> dict[str, float]:
        found = window_distances(self.arrays[query], self.ids, self.load)
        return dict(zip(self.ids, found.tolist(), strict=True))


def test_half_of_a_motion_has_the_windows_of_the_whole() -> None:
    stored = Stored()
    found = stored.asked("half")
    vectors = [stored.arrays[name][VECTOR] for name in ("half", "walk")]
    assert found["half"] < 0.05
    assert found["walk"] < 0.5 * np.linalg.norm(vectors[1] - vectors[0])
    assert 3 * found["walk"] < min(found["wave"], found["rest"])
    assert found["deleted"] == np.inf


def test_batches_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    stored = Stored()
    at_once = stored.asked("walk")
    monkeypatch.setattr(module, "BATCH", 2)
    assert stored.asked("walk") == at_once


def test_a_long_query_has_few_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    stored = Stored()
    monkeypatch.setattr(module, "MAX_WINDOWS", 2)
    found = stored.asked("walk")
    assert found["walk"] < found["wave"]
