"""The verification of a library names all damage."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import update

from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, NewClip
from app.store.database.tables import clip_arrays
from app.store.store import Store
from app.store.upkeep.verify import verify
from tests.store.upkeep.test_backup import overwrite_pages


@pytest.fixture
def names(store: Store) -> list[str]:
    """The names of the files of three clips, each with one array."""
    made = []
    for name in ("walk", "run", "jump"):
        with store.files.stage(io.BytesIO(name.encode())) as staged, store.write() as tx:
            staged.keep()
            clip = clips.add_or_get(
                tx, NewClip(staged.sha256, name, staged.size, ClipLabels(name))
            ).clip
            found = {"positions": np.zeros((40, 13, 3), np.float32)}
            arrays.put_many(tx, clip.id, found, version=1)
            made.append(staged.sha256)
    return made


def test_a_whole_library(store: Store, names: list[str]) -> None:
    steps_seen: list[tuple[int, int]] = []
    found = verify(store, lambda *steps: steps_seen.append(steps))
    assert found.is_whole
    assert (found.files, found.arrays, steps_seen[-1]) == (3, 3, (3, 3))


def test_every_damage_is_named(store: Store, names: list[str], tmp_path: Path) -> None:
    flipped, lost, aside = names
    path = store.files.path(flipped)
    path.write_bytes(bytes([path.read_bytes()[0] ^ 1]) + path.read_bytes()[1:])
    store.files.path(lost).unlink()
    with store.files.stage(io.BytesIO(b"orphan")) as staged:
        staged.keep()
    with store.files.stage(io.BytesIO(b"old")) as old:
        old.keep()
    store.files.set_aside(old.sha256)
    with store.write() as tx:
        clip_id = tx.execute(
            update(clip_arrays)
            .where(clip_arrays.c.clip_id == clips.find_by_content(tx, aside).id)  # type: ignore[union-attr]
            .values(shape="41x13x3")
            .returning(clip_arrays.c.clip_id)
        ).scalar_one()
    found = verify(store)
    assert not found.is_whole
    assert (found.damaged, found.missing) == ((flipped,), (lost,))
    assert found.unreadable == (f"{clip_id}/positions",)
    assert found.unknown == (staged.sha256,)
    assert found.quarantine.names == (old.sha256,)
    assert found.damage == ()


@pytest.mark.sqlite_only
def test_pages_of_noise_are_damage(store: Store, names: list[str]) -> None:
    overwrite_pages(store)
    found = verify(store)
    assert not found.is_whole
    assert found.damage
