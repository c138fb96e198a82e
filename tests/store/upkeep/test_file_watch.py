"""Missing and damaged files are found in the background, and their repair too."""

from __future__ import annotations

import io
from contextlib import suppress
from pathlib import Path

import pytest

from app.errors import FileDamaged, NotFound
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, NewClip
from app.store.jobs import outcomes
from app.store.store import Store
from app.store.upkeep import file_watch
from app.store.upkeep.file_watch import BadFiles, FileWatch


@pytest.fixture
def names(store: Store) -> list[str]:
    """The names of the files of three clips."""
    made = []
    for name in ("walk", "run", "jump"):
        with store.files.stage(io.BytesIO(name.encode())) as staged, store.write() as tx:
            staged.keep()
            clips.add_or_get(tx, NewClip(staged.sha256, name, staged.size, ClipLabels(name)))
            made.append(staged.sha256)
    return made


def flip(path: Path) -> bytes:
    """Flip one bit of a file; returns its bytes before."""
    before = path.read_bytes()
    path.write_bytes(bytes([before[0] ^ 1]) + before[1:])
    return before


def step_until_read(watched: FileWatch) -> None:
    """Two steps: the first makes the list of files, the second reads all of them."""
    watched.step()
    watched.step()


def test_a_whole_library_has_no_bad_file(store: Store, names: list[str]) -> None:
    watched = FileWatch(store)
    step_until_read(watched)
    assert not watched.bad


def test_bad_files_are_found_without_a_request_and_their_repair_too(
    store: Store, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(file_watch, "WORK_S", 60.0)
    flipped, lost, _ = names
    before = flip(store.files.path(flipped))
    away = store.files.path(lost)
    away.rename(away.with_suffix(".away"))
    watched = FileWatch(store)
    step_until_read(watched)
    assert watched.bad == BadFiles(frozenset([lost]), frozenset([flipped]))
    store.files.path(flipped).write_bytes(before)
    away.with_suffix(".away").rename(away)
    watched.step()
    assert not watched.bad


def test_a_file_that_a_request_finds_bad_is_looked_at_at_once(
    store: Store, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(file_watch, "WORK_S", 0.0)  # the round of all files stands still
    watched = FileWatch(store)
    watched.step()
    flip(store.files.path(names[0]))
    store.files.path(names[1]).unlink()
    watched.step()
    assert not watched.bad
    with pytest.raises(FileDamaged):
        store.files.checked_path(names[0])
    with pytest.raises(NotFound):
        store.files.path(names[1])
    watched.step()
    assert watched.bad == BadFiles(frozenset([names[1]]), frozenset([names[0]]))


def test_the_file_of_a_deleted_clip_is_not_missed(store: Store, names: list[str]) -> None:
    watched = FileWatch(store)
    watched.step()
    with store.write() as tx:
        gone = clips.find_by_content(tx, names[0])
        assert gone is not None
        outcomes.remove_clip(tx, gone.id)
    with suppress(NotFound):
        store.files.path(names[0])
    watched.step()
    assert not watched.bad
