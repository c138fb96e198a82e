from __future__ import annotations

import numpy as np
import pytest

from app.models.words import symbol_space
from app.models.words.symbol_space import SymbolSpace, fit_symbol_space, symbol_distances
from tests.models.word_clips import word_clips


def test_points_lie_as_far_apart_as_their_symbols() -> None:
    symbols = word_clips(4)[0]
    space = fit_symbol_space(symbols)
    points = space.points
    apart = np.linalg.norm(points[:, None] - points, axis=2)
    assert np.corrcoef(apart.ravel(), symbol_distances(symbols, symbols).ravel())[0, 1] > 0.95


def test_landmarks_give_nearly_the_same_space(monkeypatch: pytest.MonkeyPatch) -> None:
    symbols = word_clips(10)[0]
    monkeypatch.setattr(symbol_space, "MAX_WHOLE_LIBRARY", 20)
    monkeypatch.setattr(symbol_space, "LANDMARKS", 25)
    space = fit_symbol_space(symbols)
    assert len(space.landmarks) == 25
    points = space.place(symbols)
    nearest = np.linalg.norm(points[:, None] - points, axis=2) + np.eye(len(points)) * 1e9
    assert (nearest.argmin(axis=1) % 4 == np.arange(len(points)) % 4).mean() > 0.9


def test_a_new_symbol_is_placed_near_a_similar_one() -> None:
    symbols = word_clips(6)[0]
    space = fit_symbol_space(symbols[:-4])
    points = space.place(symbols[-4:])
    apart = np.linalg.norm(points[:, None] - space.points, axis=2)
    assert (apart.argmin(axis=1) % 4 == np.arange(4)).all()


def test_a_record_comes_back_from_its_arrays() -> None:
    symbols = word_clips(2)[0]
    space = fit_symbol_space(symbols[:5])
    arrays, meta = space.to_arrays()
    again = SymbolSpace.from_arrays(arrays, meta)
    np.testing.assert_allclose(again.place(symbols), space.place(symbols), atol=1e-9)
    with pytest.raises(ValueError, match="version"):
        SymbolSpace.from_arrays(arrays, {"version": 0})


def test_one_symbol_is_a_space() -> None:
    symbols = word_clips(1)[0]
    assert np.isfinite(fit_symbol_space(symbols[:1]).place(symbols)).all()
    assert fit_symbol_space(symbols).place([]).shape == (0, 10)
