"""Searches by example against every distance computed: what is left unmeasured changes nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.numerics.alignment.dtw import dtw_distances
from app.numerics.arrays import FloatArray
from app.search.example.by_example import COMPARED, rank_by_example
from app.search.example.distances import ACTIVE, EPSILON, FEATURES, RHO, Descriptors
from app.search.example.fusion import SHORTLIST
from app.search.example.methods import Method
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.rows import Rows
from app.search.index.vector_index import MOTION_VECTORS, PACED, VECTOR, VectorIndex
from app.store.clips.filter import ClipFilter
from tests.bodies import motion_of, walking, waving
from tests.search.fused import fused_distances
from tests.search.indexed import indexed
from tests.search.local_index import LocalLibrary
from tests.search.walking import walk

COUNT = SHORTLIST + 40


WHOLE = np.array([0.0, 1e3])
"""All of a clip is active."""


class Gallery:
    """Clips of five kinds, as an index and a store have them, and the features that were read."""

    def __init__(self) -> None:
        rng = np.random.default_rng(5)
        kinds = rng.normal(size=(5, 128)), rng.normal(size=(5, 82))
        of = rng.integers(5, size=COUNT)
        self.vectors = kinds[0][of] + 0.3 * rng.normal(size=(COUNT, 128))
        self.vectors = self.vectors.astype(np.float32)
        self.features = {
            f"c{i:03d}": (kinds[1][of[i]] + rng.normal(size=(rng.integers(3, 20), 82))).astype("f4")
            for i in range(COUNT)
        }
        self.read: list[str] = []
        rows = Rows(MOTION_VECTORS)
        rows.put([indexed(i, v) for i, v in zip(self.features, self.vectors, strict=True)])
        self.rows = rows.view()

    def nearest(self, query: FloatArray, clip_filter: ClipFilter, exclude: Any) -> NearestRanking:
        return NearestRanking(1, self.rows, self.rows.labels.mask(clip_filter, exclude), query)

    def load(self, clip_ids: Sequence[str], name: str) -> Mapping[str, FloatArray]:
        if name == ACTIVE:
            return dict.fromkeys(clip_ids, WHOLE)
        self.read.extend(clip_ids)
        return {clip_id: self.features[clip_id] for clip_id in clip_ids}

    def query(self) -> Descriptors:
        rng = np.random.default_rng(9)
        vector = self.vectors[0] + 0.1 * rng.normal(size=128)
        return {
            VECTOR: vector.astype(np.float32),
            FEATURES: self.features["c000"][:-1],
            ACTIVE: WHOLE,
            RHO: np.zeros(13),
            EPSILON: np.zeros(2),
        }

    def expected(self, query: Descriptors) -> list[tuple[float, str]]:
        """The shortlist's fused distances, all measured at once, in order."""
        near = np.linalg.norm(self.vectors.astype(float) - query[VECTOR], axis=1)
        chosen = np.argsort(near, kind="stable")[:SHORTLIST]
        ids = [f"c{i:03d}" for i in chosen]
        warped = dtw_distances(query[FEATURES], [self.features[i] for i in ids])
        fused = fused_distances(query[VECTOR], self.vectors[chosen], warped)
        return sorted(zip(np.round(fused, 9).tolist(), ids, strict=True))


@pytest.mark.parametrize("size", [7, 130, 1000])
def test_pages_of_fused_are_those_of_all_distances_measured_at_once(size: int) -> None:
    gallery = Gallery()
    query = gallery.query()
    pages = walk(
        lambda after: rank_by_example(
            cast("VectorIndex", gallery),
            query,
            Method.FUSED,
            ClipFilter(),
            frozenset(),
            gallery.load,
            after.anchor if after else None,
        ),
        size,
    )
    expected = gallery.expected(query)
    listed = [
        (distance, str(clip_id))
        for page in pages
        for distance, clip_id in zip(page.distances.tolist(), page.ids, strict=True)
    ]
    assert listed[:SHORTLIST] == expected
    assert len({clip_id for _, clip_id in listed}) == len(listed) == COUNT
    assert [distance for distance, _ in listed] == sorted(distance for distance, _ in listed)


def _walk(number: int) -> FloatArray:
    return walking(arm=0.2 + 0.1 * number, turn=0.3 * number, speed=1.0 + 0.1 * number)


def _motions() -> dict[str, dict[str, FloatArray]]:
    """Walks on several curves, and waves, described."""
    made = {f"walk {n}": _walk(n) for n in range(4)}
    made |= {f"wave {n}": waving(3 + 0.3 * n) for n in range(4)}
    return {
        name: dict(describe_for_search(motion_of(body), COMPARED).arrays)
        for name, body in made.items()
    }


@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_a_clip_at_another_tempo_finds_its_original(factor: float) -> None:
    original = motion_of(_walk(1))
    library = LocalLibrary(_motions())
    played = replace(original, frame_rate=factor * original.frame_rate)
    query = dict(describe_for_search(played, COMPARED).arrays)
    assert library.rank(query, Method.FUSED).ids[0] == "walk 1"


def test_pages_at_any_tempo_are_the_whole_ranking_also_without_vectors_at_a_common_pace() -> None:
    clips = _motions()
    del clips["walk 2"][PACED]  # a clip that waits for a new analysis
    query = clips["walk 0"]
    whole = LocalLibrary(clips).rank(query, Method.FUSED)
    assert whole.ids[0] == "walk 0"
    assert whole.distances[0] == 0.0
    assert set(whole.ids) == set(clips)
    pages = walk(
        lambda after: LocalLibrary(clips).rank(
            query, Method.FUSED, anchor=after.anchor if after else None
        ),
        3,
    )
    assert [i for page in pages for i in page.ids] == list(whole.ids)


def test_a_short_page_of_fused_reads_few_features() -> None:
    gallery = Gallery()
    found = rank_by_example(
        cast("VectorIndex", gallery),
        gallery.query(),
        Method.FUSED,
        ClipFilter(),
        frozenset(),
        gallery.load,
    )
    found.page(None, 10)
    assert len(gallery.read) == len(set(gallery.read)) < SHORTLIST / 2
