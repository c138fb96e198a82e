"""Rankings of the library for a clip."""

from __future__ import annotations

import numpy as np
import pytest

from app.evaluate.retrieval.rankings import Volumes, by_method
from app.search.example.methods import Method
from app.services.library.library import Library
from app.store.clips.record import ClipRecord


@pytest.mark.parametrize("method", [Method.MSV_DTW, Method.MSV_XCORR])
def test_recomputed_volumes_rank_like_searches(
    ready_library: Library, ready_clips: list[ClipRecord], method: Method
) -> None:
    ready_library.index.catch_up(ready_library.store)
    volumes = Volumes.of(ready_library, ready_clips, q=2, threshold=0.0)
    anew, stored = volumes.by(method), by_method(ready_library, method, None)
    for clip in ready_clips:
        assert list(anew(clip)) == list(stored(clip))


def test_a_threshold_changes_the_volumes(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    steps: list[None] = []
    plain = Volumes.of(ready_library, ready_clips[:2], q=2, threshold=0.0)
    near = Volumes.of(
        ready_library, ready_clips[:2], q=2, threshold=0.3, step=lambda: steps.append(None)
    )
    assert len(steps) == 2
    for clip in ready_clips[:2]:
        assert len(near.factors[clip.id].secondary) == len(plain.factors[clip.id].secondary)
        assert not np.allclose(near.factors[clip.id].primary, plain.factors[clip.id].primary)
