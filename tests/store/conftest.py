"""A store on a real database, which is made once and copied for each test."""

from __future__ import annotations

import dataclasses
import hashlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from app.config import sqlite_url
from app.store.clips import repository as clips
from app.store.clips.record import ClipFacts, ClipLabels, ClipRecord, ClipWarning, NewClip
from app.store.database import schema
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobRecord, NewJob
from app.store.store import Store
from tests import databases


@pytest.fixture(scope="session")
def empty_database(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("database") / "empty.sqlite3"
    schema.upgrade(sqlite_url(path))
    return path


@pytest.fixture
def database_url(empty_database: Path, tmp_path: Path) -> str:
    if databases.is_sqlite():
        shutil.copy(empty_database, tmp_path / "kinedex.sqlite3")
    return databases.url_for(tmp_path)


@pytest.fixture
def store(database_url: str, tmp_path: Path) -> Iterator[Store]:
    opened = Store.open(database_url, tmp_path / "files")
    yield opened
    opened.close()


LABELS = {field.name for field in dataclasses.fields(ClipLabels)}


def new_clip(name: str, **fields: Any) -> NewClip:
    """A clip with this name. Other labels and fields of NewClip are keywords."""
    sha256 = hashlib.sha256(name.encode()).hexdigest()
    labels = {key: fields.pop(key) for key in LABELS & fields.keys()}
    return NewClip(sha256, f"{name}.bvh", 7, ClipLabels(name, **labels), **fields)


def facts(**changes: Any) -> ClipFacts:
    values: dict[str, Any] = {
        "format": "bvh",
        "frames": 90,
        "frame_rate": 30.0,
        "declared_frame_rate": 120.0,
        "duration": 3.0,
        "joints": 22,
        "metres_per_unit": 0.01,
        "roles": {"hips": "Hips"},
        "missing_roles": ("left_hand",),
        "warnings": (ClipWarning("frame_rate_suspect", "looks like 60", 60.0),),
        "analysis_version": 1,
        "start_offset": 1.25,
    }
    return ClipFacts(**values | changes)


ON_ONE_STORE = settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
"""Settings of properties whose examples share the store of a test."""

AddClip = Callable[..., ClipRecord]
AddJob = Callable[..., JobRecord]


@pytest.fixture
def add_clip(store: Store) -> AddClip:
    """Adds a clip; `ready=True` (or a dict of facts) makes it ready."""

    def add(name: str, *, ready: bool | dict[str, Any] = False, **fields: Any) -> ClipRecord:
        with store.write() as tx:
            clip = clips.add_or_get(tx, new_clip(name, **fields)).clip
            if ready is False:
                return clip
            clips.set_ready(tx, clip.id, facts(**(ready if ready is not True else {})))
            return clips.get(tx, clip.id)

    return add


@pytest.fixture
def add_job(store: Store) -> AddJob:
    def add(kind: JobKind = JobKind.INGEST, **fields: Any) -> JobRecord:
        with store.write() as tx:
            return jobs.enqueue(tx, NewJob(kind, **fields))

    return add
