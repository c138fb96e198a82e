"""A library as the first version of Kinedex left it: the schema 0001, its rows written by SQL.

Nothing here uses today's tables, so that a change of them cannot change the past too.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from alembic import command
from numpy.typing import NDArray
from sqlalchemy import text

from app.config import sqlite_url
from app.store.database import schema
from app.store.database.engine import Database, Tx
from app.store.upkeep.backup import DATABASE, FILES

FIRST = "0001"
AT = "2026-11-22 09:00:00.000000"
READY, WAITING, FAILED = "clip_ready", "clip_waiting", "clip_failed"
"""Ids of clips; those that are ready have a number after this."""
ARRAYS = (
    "positions",
    "parents",
    "joint_names",
    "role_positions",
    "features_10hz",
    "motion_vector",
    "msv_lambda",
    "msv_rho",
    "msv_epsilon",
    "motion_sample",
    "symbol_statistics",
)
"""The arrays of the first analysis."""
PROBLEM = {"title": "No", "detail": "no frames", "code": "unreadable", "errors": []}
FACTS = {
    "format": "bvh",
    "frames": 60,
    "frame_rate": 30.0,
    "declared_frame_rate": 30.0,
    "duration": 2.0,
    "joints": 22,
    "metres_per_unit": 0.01,
    "missing_roles": "[]",
    "warnings": json.dumps([{"code": "old", "detail": "an old doubt", "likely": None}]),
    "analysis_version": 1,
}

Motion = tuple[bytes, Mapping[str, str], Mapping[str, NDArray[Any]]]
"""The bytes of a file, its joint by role, and the arrays of its analysis."""


def made_motion(name: str) -> Motion:
    """A motion that no test reads: small arrays of zeros under the old names."""
    return name.encode(), {"hips": "Hips"}, {each: np.zeros((2, 3), "<f4") for each in ARRAYS}


def make_first_library(folder: Path, motions: Sequence[Motion]) -> None:
    """A library with one ready clip for each motion, a clip that waits, and one that failed.

    Every table has rows: words, arrays, jobs, files of an import, a model, keys, a deleted clip.
    """
    folder.mkdir(parents=True)
    database = Database(sqlite_url(folder / DATABASE), foreign_keys=False)
    with database.migrate() as tx:
        command.upgrade(schema._config(tx), FIRST)
        for number, (content, roles, arrays) in enumerate(motions):
            _add_ready(tx, f"{READY}{number}", _store(folder, content), roles, arrays)
        _add_clip(tx, WAITING, _store(folder, b"a clip that waits"), state="queued")
        _add_clip(
            tx, FAILED, _store(folder, b"no motion"), state="failed", error=json.dumps(PROBLEM)
        )
        _add_others(tx)
    database.close()


def _store(folder: Path, content: bytes) -> str:
    sha256 = hashlib.sha256(content).hexdigest()
    path = folder / FILES / sha256[:2] / sha256[2:4] / sha256
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return sha256


def _add_ready(
    tx: Tx,
    clip_id: str,
    sha256: str,
    roles: Mapping[str, str],
    arrays: Mapping[str, NDArray[Any]],
) -> None:
    labels = {"person": "ada", "task": "walk", "license": "CC0-1.0", "source": "studio"}
    _add_clip(
        tx,
        clip_id,
        sha256,
        state="ready",
        changed_version=3,
        roles=json.dumps(roles),
        **FACTS,
        **labels,
    )
    for position, word in enumerate(("walk", "slow")):
        _insert(tx, "clip_words", clip_id=clip_id, word=word, position=position)
    for name, array in arrays.items():
        _insert(tx, "clip_arrays", clip_id=clip_id, name=name, version=1, **_blob(array))


def _add_clip(tx: Tx, clip_id: str, sha256: str, **values: Any) -> None:
    common = {
        "id": clip_id,
        "content_key": sha256,
        "sha256": sha256,
        "file_name": f"{clip_id}.bvh",
        "file_size": 7,
        "name": clip_id.title(),
        "name_folded": clip_id,
        "changed_version": 0,
        "created_at": AT,
        "frame_rate_override": 30.0,
    }
    _insert(tx, "clips", **(common | values))


def _add_others(tx: Tx) -> None:
    job = {"priority": 0, "progress": 0.0, "attempts": 0, "max_attempts": 3, "created_at": AT}
    job |= {"cancel_requested": False, "payload": "{}"}
    counts = {"total": 2, "ready": 1, "exists": 0, "failed": 1, "deleted": 0, "absent": 0}
    waits = {"clip_id": WAITING, "dedupe_key": f"ingest:{WAITING}"}
    _insert(tx, "jobs", **job, id="job_waiting", kind="ingest", state="queued", **waits)
    done = {"state": "succeeded", "finished_at": AT, "result": json.dumps(counts)}
    _insert(tx, "jobs", **job, id="job_import", kind="import", **done)
    entry = {"job_id": "job_import", "path": "a/walk.bvh", "clip_id": f"{READY}0"}
    _insert(tx, "import_entries", **entry, outcome="exists")
    failed = {"job_id": "job_import", "path": "b.bvh", "problem": json.dumps(PROBLEM)}
    _insert(tx, "import_entries", **failed, outcome="failed")
    model = {"id": "model_old", "kind": "recogniser", "version": 1, "library_version": 3}
    _insert(tx, "models", **model, library_size=1, meta='{"persons": ["ada"]}', created_at=AT)
    array = _blob(np.arange(6.0).reshape(2, 3))
    _insert(tx, "model_arrays", model_id="model_old", name="weights", **array)
    for key_id, revoked in (("abcdef", None), ("fedcba", AT)):
        key = {"id": key_id, "name": key_id, "role": "admin", "secret_sha256": "0" * 64}
        _insert(tx, "api_keys", **key, created_at=AT, revoked_at=revoked)
    _insert(tx, "tombstones", clip_id="clip_deleted", version=2)
    tx.execute(text("UPDATE library SET version = 3"))


def _blob(array: NDArray[Any]) -> dict[str, Any]:
    shape = "x".join(map(str, array.shape))
    return {"dtype": array.dtype.str, "shape": shape, "data": array.tobytes()}


def _insert(tx: Tx, table: str, **values: Any) -> None:
    names = ", ".join(values)
    tx.execute(
        text(f"INSERT INTO {table} ({names}) VALUES ({', '.join(f':{n}' for n in values)})"), values
    )


def rows_of(path: Path) -> dict[str, list[dict[str, Any]]]:
    """All rows of all tables of a database, as its columns are."""
    database = Database.at(path)
    with database.read() as tx:
        names = tx.execute(text("SELECT name FROM sqlite_master WHERE type = 'table'")).scalars()
        found = {
            name: [dict(row) for row in tx.execute(text(f"SELECT * FROM {name}")).mappings()]
            for name in names.all()
        }
    database.close()
    return found
