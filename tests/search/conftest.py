"""An empty store, and clips with random motion vectors for it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.search.index.vector_index import VECTOR, WIDTH
from app.store.clips.record import ClipRecord
from app.store.database import schema
from app.store.store import Store
from tests.search.stored_clips import AddClip, put_ready


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    url = f"sqlite:///{tmp_path / 'kinedex.sqlite3'}"
    schema.upgrade(url)
    opened = Store.open(url, tmp_path / "files")
    yield opened
    opened.close()


@pytest.fixture
def add(store: Store) -> AddClip:
    """Store a ready clip with a random motion vector."""
    rng = np.random.default_rng(5)

    def ready(name: str, **fields: Any) -> ClipRecord:
        vector = rng.normal(size=WIDTH).astype(np.float32)
        return put_ready(store, name, {VECTOR: vector}, **fields)

    return ready
