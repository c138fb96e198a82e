"""A write-ahead log that is cut or has flipped bits: the commits before the damage are there."""

from __future__ import annotations

import io
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from app.config import sqlite_url
from app.store import identity
from app.store.clips import listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipLabels, NewClip
from app.store.store import Store
from app.store.upkeep.backup import DATABASE, FILES
from app.store.upkeep.sweep import sweep
from app.store.upkeep.verify import verify

COMMITS = 8
DAMAGES = 20
"""Positions of the damage that are tried."""


def _open(folder: Path) -> Store:
    url, files = sqlite_url(folder / DATABASE), folder / FILES
    return Store.open(url, files, identity.prepare(url, files))


@pytest.fixture(scope="module")
def crashed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """A library as after a power cut: COMMITS clips are in the log only; and their files."""
    folder, crash = (
        tmp_path_factory.mktemp("log") / "data",
        tmp_path_factory.mktemp("log") / "crash",
    )
    store = _open(folder)
    store.erase_traces()
    names = []
    for number in range(COMMITS):
        content = f"motion {number}".encode()
        with store.files.stage(io.BytesIO(content)) as staged, store.write() as tx:
            staged.keep()
            labels = ClipLabels(f"clip {number}")
            clips.add_or_get(tx, NewClip(staged.sha256, "a.bvh", staged.size, labels))
            names.append(staged.sha256)
    shutil.copytree(folder, crash, ignore=shutil.ignore_patterns("*-shm"))
    store.close()
    return crash, names


def _cut(log: bytes, position: int) -> bytes:
    return log[:position]


def _flip(log: bytes, position: int) -> bytes:
    changed = bytearray(log)
    changed[min(position, len(log) - 1)] ^= 1 << (position % 8)
    return bytes(changed)


@pytest.mark.parametrize("damage", [_cut, _flip])
def test_all_commits_before_the_damage_are_there(
    crashed: tuple[Path, list[str]], tmp_path: Path, damage: Callable[[bytes, int], bytes]
) -> None:
    crash, names = crashed
    log = (crash / f"{DATABASE}-wal").read_bytes()
    draw = random.Random(19)
    positions = sorted([0, len(log), *(draw.randrange(len(log)) for _ in range(DAMAGES))])
    counts = []
    for position in positions:
        folder = tmp_path / str(position)
        if folder.exists():
            continue
        shutil.copytree(crash, folder)
        (folder / f"{DATABASE}-wal").write_bytes(damage(log, position))
        store = _open(folder)
        with store.read() as tx:
            ids = listing.list_ids(tx, ClipFilter())
            found = {clip.sha256 for clip in clips.get_many(tx, ids).values()}
        # The first commits without a gap: no later one without the earlier ones.
        assert found == set(names[: len(found)])
        counts.append(len(found))
        # The library is whole, and the files of the lost commits are kept in the quarantine.
        assert verify(store).is_whole
        assert sweep(store, retention_days=30).set_aside == COMMITS - len(found)
        assert all(store.files.has(name) for name in names)
        store.close()
    if damage is _cut:
        assert counts == sorted(counts)
        assert (counts[0], counts[-1]) == (0, COMMITS)
