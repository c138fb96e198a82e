"""Fitted models: the newest of a kind is the current one, old ones are removed."""

from __future__ import annotations

import numpy as np
import pytest
from sqlalchemy import func, select

from app.errors import ModelNotFitted, NotFound
from app.store import models
from app.store.database.engine import Tx
from app.store.database.tables import model_arrays
from app.store.models import ModelRecord
from app.store.store import Store


def save(tx: Tx, kind: str, value: float) -> ModelRecord:
    arrays = {"weights": np.full((2, 3), value)}
    meta = {"words": ["run"], "figures": {"map": 0.5}}
    return models.save(tx, kind, meta=meta, arrays=arrays, library_version=7, library_size=5)


def test_nothing_is_fitted_at_first(store: Store) -> None:
    with store.read() as tx:
        assert models.list_current(tx) == ()
        assert models.current_ids(tx) == {}
        with pytest.raises(ModelNotFitted, match="words"):
            models.current(tx, "words")


def test_the_newest_model_is_the_current_one(store: Store) -> None:
    with store.write() as tx:
        save(tx, "words", 1.0)
        other = save(tx, "multilinear", 9.0)
        newest = save(tx, "words", 2.0)
    with store.read() as tx:
        assert models.current(tx, "words") == newest
        assert models.current_ids(tx) == {"multilinear": (other.id, {}), "words": (newest.id, {})}
        assert models.list_current(tx) == (other, newest)
        weights = models.load_arrays(tx, newest.id)["weights"]
    np.testing.assert_array_equal(weights, np.full((2, 3), 2.0))
    assert not weights.flags.writeable
    assert newest.meta["figures"] == {"map": 0.5}


def test_old_models_are_removed_with_their_arrays(store: Store) -> None:
    with store.write() as tx:
        for value in range(5):
            save(tx, "words", value)
        count = tx.execute(select(func.count()).select_from(model_arrays)).scalar_one()
    assert count == models.KEPT_VERSIONS


def test_arrays_with_rows_of_clips_are_loaded_only_by_name(store: Store) -> None:
    arrays = {
        "weights": np.ones(2),
        f"{models.CLIP_ARRAY_PREFIX}ids": np.ones(9),
        "clips": np.ones(3),
    }
    with store.write() as tx:
        saved = models.save(tx, "words", meta={}, arrays=arrays, library_version=1, library_size=1)
    with store.read() as tx:
        assert models.load_arrays(tx, saved.id).keys() == {"weights", "clips"}
        asked = models.load_arrays(tx, saved.id, ["clips.ids", "unknown"])
    assert asked.keys() == {"clips.ids"}


def test_settings_come_with_the_current_model(store: Store) -> None:
    with store.write() as tx:
        saved = save(tx, "words", 1.0)
        changed = models.set_settings(tx, saved.id, {"rate": 0.1})
        assert changed.settings == {"rate": 0.1}
        assert changed.meta["figures"] == saved.meta["figures"]
        with pytest.raises(NotFound):
            models.set_settings(tx, "nobody", {})
    with store.read() as tx:
        assert models.current_ids(tx) == {"words": (saved.id, {"rate": 0.1})}


def test_kinds_are_removed_with_all_versions(store: Store) -> None:
    with store.write() as tx:
        save(tx, "words", 1.0)
        save(tx, "words", 2.0)
        kept = save(tx, "multilinear", 3.0)
        assert models.remove(tx, ["words", "recognizer"]) == 2
        assert models.list_current(tx) == (kept,)


def test_figures_that_are_no_numbers_are_refused(store: Store) -> None:
    with pytest.raises(Exception, match="JSON"), store.write() as tx:
        models.save(
            tx, "words", meta={"map": float("nan")}, arrays={}, library_version=0, library_size=0
        )
