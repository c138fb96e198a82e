"""Why a clip is a hit: the costs of the parts, and long motions."""

from __future__ import annotations

import numpy as np
import pytest

from app.search.example.methods import Method
from app.services.comparison import why
from app.services.comparison.alignment import Part, align_clips
from app.services.comparison.why import explain_hit
from app.services.find.by_parts import find_by_parts
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from tests.libraries import FindClip


def _query(*ids: str, words: tuple[str, ...] = (), method: Method = Method.FUSED) -> ComposedQuery:
    examples = [
        Example(f"examples.{place}", QuerySource(clip_id), 1.0 + place, place == 2)
        for place, clip_id in enumerate(ids)
    ]
    return ComposedQuery(examples, words, method=method, limit=100)


@pytest.mark.parametrize("words", [(), ("walk", "slow"), ("walk", "-slow")])
@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_the_costs_of_the_parts_sum_to_the_distance(
    ready_library: Library, clip_of: FindClip, words: tuple[str, ...], count: int
) -> None:
    names = (("ada", "walk"), ("bruno", "walk"), ("ada", "bow"))
    ids = [clip_of(*name).id for name in names[:count]]
    if not ids and not words:
        return
    for hit in find_by_parts(ready_library, _query(*ids, words=words)).items:
        costs = [part.cost for part in hit.parts]
        assert min(costs) >= 0
        assert sum(costs) == pytest.approx(hit.distance, abs=1e-6)


def test_the_alignment_is_that_of_the_two_clips(ready_library: Library, clip_of: FindClip) -> None:
    walk, wave = clip_of("ada", "walk").id, clip_of("bruno", "wave").id
    (reason,) = explain_hit(ready_library, _query(walk), wave).reasons
    alone = align_clips(ready_library, Part(walk), Part(wave))
    assert reason.alignment is not None
    np.testing.assert_allclose(reason.alignment.times, alone.times)
    np.testing.assert_allclose(reason.alignment.differences, alone.differences)


def test_long_motions_are_thinned(
    ready_library: Library, clip_of: FindClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    walk, wave = clip_of("ada", "walk"), clip_of("bruno", "wave")
    monkeypatch.setattr(why, "MAX_STEPS", 10)
    (reason,) = explain_hit(ready_library, _query(walk.id), wave.id).reasons
    assert reason.alignment is not None
    assert reason.seconds is not None
    assert min(reason.seconds) > 0.1
    assert len(reason.alignment.times) <= 20
    assert walk.duration is not None
    assert wave.duration is not None
    ends = reason.alignment.times[-1]
    np.testing.assert_allclose(ends, [walk.duration, wave.duration], atol=0.9)
