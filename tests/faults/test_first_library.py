"""A library of the first schema is copied, upgraded and analyzed again; nothing of it is lost."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest

from app.config import sqlite_url
from app.demo import DemoClip, demo_clips
from app.errors import ClipNotReady
from app.services.clips import reanalysis
from app.services.find.find import find_motion
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.store import identity
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.record import ClipState
from app.store.database import schema
from app.store.store import Store
from app.store.upkeep.backup import DATABASE, FILES, back_up
from app.store.upkeep.verify import verify
from tests.first_library import (
    ARRAYS,
    FAILED,
    FIRST,
    READY,
    WAITING,
    Motion,
    made_motion,
    make_first_library,
    rows_of,
)
from tests.libraries import settings_for, upload, work

Row = dict[str, Any]
RENAMED = {"recogniser": "recognizer", "exists": "unchanged"}
"""Values that migrations spell in another way."""
DROPPED = {"lease_until"}
"""Columns that were removed: no lease of a stopped worker matters."""


def _kept(before: Row, after: Row) -> bool:
    """Whether a row has every value that it had."""
    return all(
        after[name] == RENAMED.get(str(value), value)
        for name, value in before.items()
        if name not in DROPPED | {"result"}
    )


def test_every_row_and_every_file_survives(tmp_path: Path) -> None:
    folder = tmp_path / "data"
    make_first_library(folder, [made_motion("walk"), made_motion("run")])
    before = rows_of(folder / DATABASE)
    assert all(before.values()), "every table of the first schema has rows"

    url, files = sqlite_url(folder / DATABASE), folder / FILES
    old = Store.open(url, files, identity.check_copyable(url, files))
    copy = back_up(old, tmp_path / "copy").path
    old.close()
    assert rows_of(copy / DATABASE) == before

    schema.upgrade(url)
    store = Store.open(url, files, identity.prepare(url, files))
    after = rows_of(folder / DATABASE)
    for table, rows in before.items():
        if table == schema.REVISION_TABLE:
            continue
        lost = [row for row in rows if not any(_kept(row, now) for now in after[table])]
        assert not lost, (table, lost)
        assert len(after[table]) == len(rows)
    (imported,) = [row for row in after["jobs"] if row["kind"] == "import"]
    result = json.loads(imported["result"])
    assert (result["total"], result["new"], result["failed"]) == (2, 1, 1)
    assert verify(store, needed_arrays=ARRAYS).is_whole
    assert len(set(store.files)) == len(before["clips"])
    store.close()
    # The copy is still of the first schema, and can be upgraded when somebody goes back to it.
    assert schema.state(sqlite_url(copy / DATABASE)).current == FIRST
    assert schema.upgrade(sqlite_url(copy / DATABASE)).is_current


def test_old_analyses_are_found_until_a_worker_has_made_new_ones(tmp_path: Path) -> None:
    demo = list(demo_clips(("ada",), ("walk", "wave", "kick"), takes=1))
    motions = _analyzed(tmp_path / "today", demo)
    settings = settings_for(tmp_path)
    make_first_library(settings.data_dir, motions)
    schema.upgrade(settings.database)
    lib = Library.open(settings)
    first, *others = every = [f"{READY}{number}" for number in range(len(demo))]
    file = io.BytesIO(demo[0].content + b"\n")
    hits = find_motion(lib, MotionQuery(QuerySource(content=file), method="vector")).items
    assert {(hit.clip.id, hit.clip.analysis_version) for hit in hits} == {(i, 1) for i in every}
    with pytest.raises(ClipNotReady, match="will be analyzed again"):  # it lacks newer arrays
        find_motion(lib, MotionQuery(QuerySource(first)))

    work(settings)

    hits = find_motion(lib, MotionQuery(QuerySource(first))).items
    assert {hit.clip.id for hit in hits} == set(others)
    with lib.store.read() as tx:
        found = clips.get_many(tx, [first, *others, WAITING, FAILED])
    assert {found[i].analysis_version for i in (first, *others)} == {reanalysis.ANALYSIS_VERSION}
    assert (found[first].person, found[first].words) == ("ada", ("walk", "slow"))
    # The clip that waited when the old program ended has had its turn: its bytes are no motion.
    assert found[WAITING].state is ClipState.FAILED
    assert found[FAILED].error is not None
    assert found[FAILED].error["detail"] == "no frames"
    lib.close()


def _analyzed(folder: Path, demo: list[DemoClip]) -> list[Motion]:
    """Clips with the arrays that the first analysis stored, computed by today's."""
    lib = Library.open(settings_for(folder))
    ids = [upload(lib, clip).clip.id for clip in demo]
    work(lib.settings)
    with lib.store.read() as tx:
        found = [
            (clip.content, clips.get(tx, i).roles, arrays.get_named(tx, i, ARRAYS))
            for clip, i in zip(demo, ids, strict=True)
        ]
    lib.close()
    return found
