"""On a full disk nothing is stored in part, and clips can still be deleted."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.config import sqlite_url
from app.errors import DiskFull
from app.store import identity
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, ClipRecord, NewClip
from app.store.files.reserve import MIN_BYTES
from app.store.jobs import outcomes
from app.store.store import Store
from tests.full_disk import fill, small_disk

ARRAY_BYTES = 3 * 2**20
"""Size of the array of one clip: more than the free space that the log may have by chance."""


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    with small_disk(tmp_path / "disk", 48) as mounted:
        yield mounted


def open_store(folder: Path) -> Store:
    url, files = sqlite_url(folder / "kinedex.sqlite3"), folder / "files"
    return Store.open(url, files, identity.prepare(url, files))


def add(store: Store, name: str) -> ClipRecord:
    """A clip with a file and a large array."""
    with store.files.stage(io.BytesIO(name.encode())) as staged, store.write() as tx:
        staged.keep()
        clip = clips.add_or_get(
            tx, NewClip(staged.sha256, name, staged.size, ClipLabels(name))
        ).clip
        large = np.random.default_rng(1).integers(0, 255, ARRAY_BYTES, np.uint8)
        arrays.put_many(tx, clip.id, {"positions": large}, version=1)
        return clip


def test_a_clip_can_be_deleted_when_the_disk_is_full(disk: Path) -> None:
    store = open_store(disk)
    doomed = [add(store, "walk"), add(store, "run")]
    store.erase_traces()
    store.make_reserve()
    filler = fill(disk)
    with pytest.raises(DiskFull):
        add(store, "late")
    with pytest.raises(DiskFull), store.write() as tx:
        outcomes.remove_clip(tx, doomed[0].id)
    store.write_even_when_full(lambda tx: outcomes.remove_clip(tx, doomed[0].id))
    with store.read() as tx:
        assert list(clips.get_many(tx, [each.id for each in doomed])) == [doomed[1].id]
    assert set(store.files) == {doomed[1].sha256}
    reserve = disk / "kinedex.sqlite3.reserve"
    again = disk / "again"
    filler.rename(again)  # and the disk fills up a second time
    filler = fill(disk)
    store.write_even_when_full(lambda tx: outcomes.remove_clip(tx, doomed[1].id))
    assert set(store.files) == set()
    again.unlink()
    filler.unlink()
    store.make_reserve()
    assert reserve.stat().st_size >= ARRAY_BYTES  # as large as the database
    store.close()


class Full:
    """A database that is full until the reserve is given up."""

    def __init__(self, store: Store, reserve: Path) -> None:
        self.calls = 0
        self._reserve = reserve

    def __call__(self, tx: Any) -> str:
        self.calls += 1
        if self._reserve.exists():
            raise DiskFull
        return "deleted"


def test_a_deletion_is_tried_again_with_the_reserve(tmp_path: Path) -> None:
    store = open_store(tmp_path)
    store.make_reserve()
    reserve = tmp_path / "kinedex.sqlite3.reserve"
    assert reserve.stat().st_size == MIN_BYTES
    work = Full(store, reserve)
    assert store.write_even_when_full(work) == "deleted"
    assert work.calls == 2
    assert reserve.exists()  # there is free space again

    def always_full(tx: Any) -> None:
        raise DiskFull

    with pytest.raises(DiskFull):
        store.write_even_when_full(always_full)
    store.close()


def test_the_reserve_does_not_take_the_last_space(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = open_store(tmp_path)
    usage = type("Usage", (), {"free": 3 * MIN_BYTES})
    monkeypatch.setattr("app.store.files.reserve.shutil.disk_usage", lambda _: usage)
    store.make_reserve()
    assert not (tmp_path / "kinedex.sqlite3.reserve").exists()
    store.close()
