"""The motion volumes of a library."""

from __future__ import annotations

from collections import Counter

import pytest

from app import evaluate
from app.analysis.descriptors.motion_volume import compression_ratio
from app.evaluate.retrieval import volumes as under_test
from app.services.library.library import Library
from app.store.clips.arrays import get_one
from app.store.clips.record import ClipRecord


def test_factors_by_class_and_how_they_converged(ready_library: Library) -> None:
    found = evaluate.judge_volumes(ready_library, classes=["walk", "kick"])
    assert {name: len(some) for name, some in found.factors.items()} == {"walk": 3, "kick": 3}
    assert found.converged == len(found.iterations) == 6
    assert all(3 < count < 60 for count in found.iterations)
    assert all(len(one.primary) == 13 for some in found.factors.values() for one in some)


def test_the_compression_agrees_with_the_formula(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    compression = evaluate.judge_volumes(ready_library).compression
    assert compression.clips == 12
    with ready_library.store.read() as tx:
        spans = [get_one(tx, clip.id, "active_span") for clip in ready_clips]
    frames = [round(float(end - start) * 30) for start, end in spans]
    assert compression.frames == sum(frames)
    assert compression.frames < sum((clip.duration or 0) * 30 for clip in ready_clips)
    assert compression.formula == pytest.approx(compression_ratio(frames), rel=0.01)
    assert compression.measured == pytest.approx(compression.formula)


def test_a_large_class_is_sampled(ready_library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(under_test, "MAX_PER_CLASS", 2)
    monkeypatch.setattr(under_test, "CLIPS_PER_LOAD", 5)
    found = evaluate.judge_volumes(ready_library)
    assert Counter(len(some) for some in found.factors.values()) == {2: 4}
    assert found.compression.clips == 12
