"""The nearest vectors against the obvious: every distance in float64, sorted."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.nearest import DECIMALS, Block, distances_to, nearest


def _naive(vectors: np.ndarray, query: np.ndarray) -> np.ndarray:
    apart = vectors.astype(np.float32).astype(np.float64) - query.astype(np.float32)
    # vecdot: a sum in another order would differ by a last bit, and now and then by a decimal
    return np.round(np.sqrt(np.vecdot(apart, apart)), DECIMALS)


def _blocks(vectors: np.ndarray, size: int) -> list[Block]:
    return [Block.of(vectors[i : i + size]) for i in range(0, len(vectors), size)]


def _masks(blocks: list[Block], mask: np.ndarray | None) -> list[np.ndarray | None]:
    if mask is None:
        return [None] * len(blocks)
    ends = np.cumsum([len(block) for block in blocks])
    return list(np.split(mask, ends[:-1]))


@st.composite
def _questions(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """Vectors (n, d), many of them alike or equal, of any size, and a query near them."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count, width = draw(st.integers(1, 60)), draw(st.sampled_from([1, 3, 128]))
    scale = draw(st.sampled_from([1e-6, 1.0, 1e4]))
    few = rng.normal(size=(draw(st.integers(1, 8)), width))
    jitter = draw(st.sampled_from([0.0, 1e-7, 1e-3, 1.0]))
    vectors = few[rng.integers(len(few), size=count)]
    vectors = scale * (vectors + jitter * rng.normal(size=vectors.shape))
    query = vectors[0] + draw(st.sampled_from([0.0, 1e-6, 1.0])) * scale * rng.normal(size=width)
    return vectors.astype(np.float32), query.astype(np.float32)


@settings(max_examples=150, deadline=None)
@given(_questions(), st.integers(1, 12), st.integers(1, 25), st.booleans(), st.data())
def test_no_nearest_vector_is_missed(
    question: tuple[np.ndarray, np.ndarray],
    count: int,
    size: int,
    masked: bool,
    data: st.DataObject,
) -> None:
    vectors, query = question
    truth = _naive(vectors, query)
    mask = np.ones(len(vectors), dtype=bool)
    if masked:
        mask = np.array(
            data.draw(st.lists(st.booleans(), min_size=len(truth), max_size=len(truth)))
        )
    least = data.draw(st.sampled_from([None, 0.0, *truth.tolist()]))
    blocks = _blocks(vectors, size)
    rows, distances = nearest(blocks, _masks(blocks, mask if masked else None), query, count, least)
    assert np.all(np.diff(rows) > 0)
    assert mask[rows].all()
    assert distances.tolist() == pytest.approx(truth[rows].tolist(), abs=1.1 * 10**-DECIMALS)
    beyond = np.sort(truth[mask & (truth > (-1.0 if least is None else least))])
    last = beyond[:count].max(initial=-1.0)
    asked = mask & (truth <= last) & (truth >= (0.0 if least is None else least))
    asked |= mask & (truth == (-1.0 if least is None else least))
    assert set(np.flatnonzero(asked)) <= set(rows.tolist())


def test_a_pass_over_many_blocks_keeps_few() -> None:
    rng = np.random.default_rng(2)
    vectors = rng.normal(size=(20_000, 16)).astype(np.float32)
    blocks = _blocks(vectors, 1000)
    rows, distances = nearest(blocks, [None] * len(blocks), vectors[7], 10)
    truth = _naive(vectors, vectors[7])
    assert 10 <= len(rows) < 20
    assert np.sort(distances)[:10].tolist() == np.sort(truth)[:10].tolist()


def test_a_few_of_many_are_gathered_rather_than_multiplied() -> None:
    rng = np.random.default_rng(3)
    vectors = rng.normal(size=(500, 8))
    mask = np.zeros(500, dtype=bool)
    mask[[3, 77, 400]] = True
    rows, _ = nearest([Block.of(vectors)], [mask], vectors[0], 10)
    assert rows.tolist() == [3, 77, 400]


def test_a_vector_has_distance_zero_to_itself() -> None:
    rng = np.random.default_rng(4)
    vectors = (100 * rng.normal(size=(50, 128))).astype(np.float32)
    blocks = _blocks(vectors, 20)
    rows, distances = nearest(blocks, [None] * 3, vectors[30], 1)
    assert dict(zip(rows.tolist(), distances.tolist(), strict=True))[30] == 0.0


def test_empty_blocks_have_no_nearest_vectors() -> None:
    rows, distances = nearest([], [], np.zeros(3), 5)
    assert (len(rows), len(distances)) == (0, 0)
    rows, _ = nearest([Block.of(np.zeros((4, 3)))], [np.zeros(4, dtype=bool)], np.zeros(3), 5)
    assert len(rows) == 0


def test_distances_of_chosen_rows_run_through_the_blocks() -> None:
    rng = np.random.default_rng(5)
    vectors = rng.normal(size=(90, 5))
    rows = np.array([0, 19, 20, 64, 89])
    found = distances_to(_blocks(vectors, 20), rows, vectors[1])
    assert found.tolist() == _naive(vectors[rows], vectors[1]).tolist()
