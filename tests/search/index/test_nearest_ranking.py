"""Rankings that are measured as one looks, against every distance sorted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.search.example import guests as guests_module
from app.search.example.guests import Guests
from app.search.example.reranking import ShortlistRanking
from app.search.index import rows as rows_module
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.rows import Layout, Rows
from app.search.ranking.lower_bounds import LowerBounds
from app.store.clips.filter import ClipFilter
from tests.search.indexed import indexed
from tests.search.walking import walk, walked

WIDTH = 3
LAYOUT = Layout(("vector",), WIDTH)
QUERY = np.zeros(WIDTH, dtype=np.float32)
BRIEF = settings(max_examples=60, deadline=None)

Vectors = dict[str, tuple[float, ...]]


@pytest.fixture(autouse=True, scope="module")
def _small_blocks() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rows_module, "BLOCK", 7)
        yield


NUMBERS = st.sampled_from([0.0, 1.0, 1.0 + 2**-20, 2.0])
VECTORS = st.dictionaries(
    st.integers(0, 99).map("c{:02d}".format), st.tuples(*[NUMBERS] * WIDTH), max_size=30
)


def _near(vectors: Vectors, left_out: str = "", query: np.ndarray = QUERY) -> NearestRanking:
    rows = Rows(LAYOUT)
    rows.put([indexed(i, np.array(v, dtype=np.float32)) for i, v in vectors.items()])
    view = rows.view()
    return NearestRanking(1, view, view.labels.mask(ClipFilter(), [left_out]), query)


FEW = 3


@pytest.fixture(autouse=True, scope="module")
def _few_guests() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(guests_module, "GUESTS", FEW)
        yield


def _far(vectors: Vectors) -> NearestRanking:
    """Another view: the same clips by their distance to the far corner."""
    return _near(vectors, query=np.array([5.0, 2.0, 2.0], dtype=np.float32))


def _keys(vectors: Vectors) -> list[tuple[float, str]]:
    """The slow twin: (distance, id) in order."""
    return sorted(
        (round(float(np.linalg.norm(np.float32(v).astype(float))), 9), i)
        for i, v in vectors.items()
    )


@BRIEF
@given(VECTORS, st.integers(1, 9))
def test_all_pages_together_are_the_ranking(vectors: Vectors, size: int) -> None:
    near = _near(vectors)
    keys = _keys(vectors)
    assert list(near.ids) == walked(near, size) == [clip_id for _, clip_id in keys]
    assert near.distances.tolist() == pytest.approx([d for d, _ in keys], abs=2e-9)
    assert len(near) == len(vectors)


@BRIEF
@given(VECTORS, st.sampled_from([0.0, 1.0, 1.5]), st.integers(0, 99).map("c{:02d}".format))
def test_the_clips_up_to_a_clip_are_listed(vectors: Vectors, distance: float, clip_id: str) -> None:
    page = _near(vectors).until(distance, clip_id)
    expected = [i for d, i in _keys(vectors) if (d, i) <= (distance, clip_id)]
    assert list(page.ids) == expected
    assert page.more == (len(expected) < len(vectors))


def test_excluded_clips_are_neither_ranked_nor_counted() -> None:
    near = _near({"a": (0, 0, 0), "b": (1, 0, 0)}, left_out="a")
    assert (list(near.ids), len(near)) == (["b"], 1)


def _bounds(ids: np.ndarray, distances: np.ndarray) -> LowerBounds:
    """Distances that are known, behind bounds that are sometimes far below them."""
    shares = np.array([int(str(clip_id)[1:]) % 5 / 4 for clip_id in ids])
    finite = np.where(np.isfinite(distances), distances, 1.0)
    return LowerBounds(ids, finite * shares, lambda rows: distances[rows])


def _backwards(ids: np.ndarray) -> LowerBounds:
    """Ranks anew by something that has nothing to do with the first stage: the id's digits."""
    return _bounds(ids, np.array([100.0 - int(i[1:]) for i in ids]))


@BRIEF
@given(VECTORS, st.integers(1, 9), st.integers(1, 12))
def test_a_shortlist_comes_first_and_the_other_clips_keep_their_order(
    vectors: Vectors, size: int, shortlist: int
) -> None:
    found = ShortlistRanking(_near(vectors), _backwards, shortlist)
    order = [clip_id for _, clip_id in _keys(vectors)]
    expected = sorted(order[:shortlist], reverse=True) + order[shortlist:]
    assert list(found.ids) == expected
    assert np.all(np.diff(found.distances) >= 0)
    pages = walk(
        lambda after: ShortlistRanking(
            _near(vectors), _backwards, shortlist, after.anchor if after else None
        ),
        size,
    )
    assert [str(i) for page in pages for i in page.ids] == expected
    together = np.concatenate([page.distances for page in pages])
    assert together.tolist() == found.distances.tolist()


CHANGES = st.lists(
    st.lists(
        st.tuples(
            st.integers(0, 99).map("c{:02d}".format), st.none() | st.tuples(*[NUMBERS] * WIDTH)
        ),
        max_size=4,
    ),
    max_size=12,
)


@BRIEF
@given(VECTORS, st.integers(1, 9), st.integers(1, 12))
def test_guests_join_the_shortlist_and_are_listed_once(
    vectors: Vectors, size: int, shortlist: int
) -> None:
    def ranked(after: Any) -> ShortlistRanking:
        anchor = after.anchor if after else None
        near = _near(vectors)
        return ShortlistRanking(near, _backwards, shortlist, anchor, Guests(near, _far(vectors)))

    order = [clip_id for _, clip_id in _keys(vectors)]
    guests = _far(vectors).page(None, FEW).ids.tolist()
    head = {*order[:shortlist], *guests}
    expected = sorted(head, reverse=True) + [i for i in order if i not in head]
    pages = walk(ranked, size)
    assert [str(i) for page in pages for i in page.ids] == expected
    together = np.concatenate([page.distances for page in pages])
    assert (np.diff(together) >= 0).all()


def test_guests_that_the_first_stage_does_not_rank_are_not_listed() -> None:
    vectors: Vectors = {f"c{n:02d}": (float(n), 0.0, 0.0) for n in range(6)}
    near = _near(vectors, left_out="c05")
    found = ShortlistRanking(near, _backwards, 1, None, Guests(near, _far(vectors)))
    assert list(found.ids) == ["c04", "c03", "c00", "c01", "c02"]


def test_distances_of_clips_are_those_of_the_ranking() -> None:
    vectors: Vectors = {"a": (0, 0, 0), "b": (1, 0, 0), "c": (1, 2, 2)}
    near = _near(vectors, left_out="b")
    asked = np.array(["c", "b", "gone", "a"], dtype=object)
    assert near.distances_of(asked).tolist() == [3.0, np.inf, np.inf, 0.0]
    assert _near({}).distances_of(asked).tolist() == [np.inf] * 4


@BRIEF
@given(VECTORS, st.integers(1, 9), st.integers(1, 12), CHANGES, st.sampled_from([0, 1, 2]))
def test_no_clip_is_missed_or_listed_twice_if_clips_are_added_and_deleted_between_pages(
    vectors: Vectors, size: int, shortlist: int, changes: list[Any], stages: int
) -> None:
    """Clips that were there all the time are listed once; none is listed twice."""
    now, stayed = dict(vectors), set(vectors)
    to_come = iter(changes)

    def ranked(after: Any) -> Any:
        if after is not None:
            for clip_id, vector in next(to_come, []):
                if clip_id in stayed and vector is not None:
                    continue  # a clip that is changed may stand elsewhere, which is no mistake
                stayed.discard(clip_id)
                now.pop(clip_id, None)
                if vector is not None:
                    now[clip_id] = vector
        near = _near(now)
        if not stages:
            return near
        guests = Guests(near, _far(now)) if stages == 2 else None
        anchor = after.anchor if after else None
        return ShortlistRanking(near, _backwards, shortlist, anchor, guests)

    listed = [str(i) for page in walk(ranked, size) for i in page.ids]
    came_twice = {i for i in listed if listed.count(i) > 1}
    assert came_twice & stayed == set()
    assert stayed <= set(listed)


def test_a_deleted_clip_of_the_shortlist_is_left_out() -> None:
    vectors: Vectors = {f"c{n:02d}": (float(n), 0.0, 0.0) for n in range(6)}

    def gone(ids: np.ndarray) -> LowerBounds:
        return _bounds(ids, np.where(ids == "c00", np.inf, [float(i[1:]) for i in ids]))

    found = ShortlistRanking(_near(vectors), gone, 3)
    assert list(found.ids) == ["c01", "c02", "c03", "c04", "c05"]
    everyone_gone = ShortlistRanking(
        _near(vectors), lambda ids: _bounds(ids, np.full(len(ids), np.inf)), 3
    )
    assert list(everyone_gone.ids) == ["c03", "c04", "c05"]


def test_a_ranking_without_clips_is_empty() -> None:
    page = ShortlistRanking(_near({}), _backwards, 5).page(None, 10)
    assert (len(page.ids), page.more) == (0, False)
