"""Libraries on real databases: empty ones, and one with demo clips that a worker has analyzed."""

from __future__ import annotations

import io
import shutil
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from app.config import Settings
from app.demo import DemoClip, demo_clips
from app.services.clips import catalogue as clips
from app.services.clips.catalogue import Created
from app.services.library.library import Library
from app.services.training import models
from app.store.clips.record import ClipRecord
from app.worker.loop import run_worker
from tests import databases

ACTORS = ("ada", "bruno", "chika")
TASKS = ("walk", "wave", "kick", "bow")


def settings_for(folder: Path, **changes: Any) -> Settings:
    values = {"analysis_processes": 1, **changes}
    if not databases.is_sqlite():
        values.setdefault("database_url", databases.url_for(folder))
    return Settings(data_dir=folder / "data", **values)


def work(settings: Settings) -> None:
    """Run a worker in this thread until there is no job left."""
    run_worker(settings, threading.Event(), until=lambda lib: True)


def upload(lib: Library, clip: DemoClip, **fields: Any) -> Created:
    labels = {"person": clip.person, "task": clip.task, "words": clip.words} | fields
    return clips.create_clip(lib, io.BytesIO(clip.content), clip.path, labels)


@pytest.fixture
def lib(tmp_path: Path) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path))
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def some_demo_clips() -> list[DemoClip]:
    return list(demo_clips(ACTORS, TASKS, takes=1))


@pytest.fixture(scope="session")
def ready_library(
    tmp_path_factory: pytest.TempPathFactory, some_demo_clips: list[DemoClip]
) -> Iterator[Library]:
    """Twelve ready clips with fitted models. Tests that share it must not change it."""
    opened = Library.open(settings_for(tmp_path_factory.mktemp("ready"), analysis_processes=2))
    for clip in some_demo_clips:
        upload(opened, clip, license="CC0-1.0", source="demo")
    models.request_fit(opened)
    work(opened.settings)
    yield opened
    opened.close()


@pytest.fixture
def mine(ready_library: Library, tmp_path: Path) -> Iterator[Library]:
    """A copy of the ready library, which a test may change."""
    shutil.copytree(ready_library.settings.data_dir, tmp_path / "data")
    opened = Library.open(settings_for(tmp_path))
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def ready_clips(ready_library: Library) -> list[ClipRecord]:
    return list(clips.list_clips(ready_library, sort="name", limit=100).items)


FindClip = Callable[[str, str], ClipRecord]


@pytest.fixture
def clip_of(ready_clips: list[ClipRecord]) -> FindClip:
    def find(person: str, task: str) -> ClipRecord:
        return next(c for c in ready_clips if (c.person, c.task) == (person, task))

    return find
