"""What every store of files does, in a folder and in a bucket."""

from __future__ import annotations

import hashlib
import io
import os
from pathlib import Path

import pytest

from app.errors import BadField, NotFound, StorageError, TooLarge
from app.store.files.files import FileStore
from app.store.files.local_files import LocalFiles
from app.store.files.places import open_files
from tests.buckets import Buckets

LIBRARY = "library_one"


@pytest.fixture(params=["folder", "bucket"])
def files(request: pytest.FixtureRequest, tmp_path: Path) -> FileStore:
    if request.param == "folder":
        made: FileStore = LocalFiles(tmp_path / "files", LIBRARY)
    else:
        s3: Buckets = request.getfixturevalue("s3")
        made = open_files(s3.new(tmp_path / "files"), LIBRARY)
    made.write_id(LIBRARY)
    return made


def put(files: FileStore, content: bytes) -> str:
    with files.stage(io.BytesIO(content)) as staged:
        staged.keep()
    return staged.sha256


def temporaries(files: FileStore) -> list[Path]:
    return list((files.root / "tmp").glob("*"))


@pytest.mark.parametrize("size", [0, 1, 3 * 2**20 + 17, 20 * 2**20 + 1])
def test_kept_content_is_found_by_its_hash(files: FileStore, size: int) -> None:
    content = os.urandom(size)
    with files.stage(io.BytesIO(content)) as staged:
        with staged.open() as file:
            assert file.read(3) == content[:3]
        assert not files.has(staged.sha256)
        staged.keep()
    assert (staged.sha256, staged.size) == (hashlib.sha256(content).hexdigest(), size)
    with files.open(staged.sha256) as file:
        assert file.read() == content
    files.check(staged.sha256)
    assert files.checked_path(staged.sha256).read_bytes() == content
    assert list(files) == [staged.sha256]
    assert temporaries(files) == []


def test_the_same_bytes_are_kept_once(files: FileStore) -> None:
    assert put(files, b"walk") == put(files, b"walk")
    assert len(list(files)) == 1


def test_content_that_is_not_kept_is_removed(files: FileStore) -> None:
    with files.stage(io.BytesIO(b"walk")):
        pass
    with pytest.raises(RuntimeError), files.stage(io.BytesIO(b"run")):
        raise RuntimeError
    with pytest.raises(TooLarge), files.stage(io.BytesIO(b"jump"), max_bytes=3):
        pass
    assert list(files) == temporaries(files) == []


def test_missing_and_malformed_names(files: FileStore) -> None:
    absent = "0" * 64
    for look in (files.open, files.path, files.checked_path, files.check):
        with pytest.raises(NotFound):
            look(absent)
    assert absent in files.suspects
    for name in ("", "../../etc/passwd", "A" * 64, "0" * 63 + "\n"):
        with pytest.raises(BadField):
            files.path(name)
    files.remove(absent)
    assert not files.has(absent)
    kept = put(files, b"walk")
    assert files.missing([absent, kept]) == {absent}


def test_the_quarantine_gives_back_what_somebody_needs(files: FileStore) -> None:
    walk, run = put(files, b"walk"), put(files, b"run")
    files.set_aside(walk)
    files.set_aside(run)
    assert list(files) == []
    assert sorted(files.quarantine) == sorted([walk, run])
    assert files.has(walk)
    assert files.missing([walk, run]) == frozenset()
    assert files.path(walk).read_bytes() == b"walk"
    assert files.bring_back(run)
    assert not files.bring_back(run)
    assert sorted(files) == sorted([walk, run])
    assert files.quarantine.content().names == ()
    files.set_aside(walk)
    put(files, b"walk")  # stored again meanwhile
    assert not files.bring_back(walk)
    assert list(files.quarantine) == []


def test_a_purge_removes_only_what_is_old(files: FileStore) -> None:
    walk = put(files, b"walk")
    files.set_aside(walk)
    assert files.quarantine.purge(3600) == ()
    content = files.quarantine.content()
    assert (content.names, content.bytes) == ((walk,), 4)
    assert files.quarantine.purge(-1) == (walk,)
    assert not files.has(walk)


def test_a_removed_file_is_gone_everywhere(files: FileStore) -> None:
    walk, run = put(files, b"walk"), put(files, b"run")
    files.path(walk)
    files.set_aside(run)
    for name in (walk, run):
        files.remove(name)
        assert not files.has(name)
    assert not [path for path in files.root.rglob("*") if path.name in (walk, run)]


def test_the_first_id_stays_unless_it_is_replaced(files: FileStore) -> None:
    files.write_id("library_two")
    assert files.read_id() == LIBRARY
    files.check_identity()
    files.write_id("library_two", replaces=True)
    assert files.read_id() == "library_two"
    with pytest.raises(StorageError, match="library_two"):
        files.check_identity()
    with pytest.raises(StorageError), files.stage(io.BytesIO(b"walk")):
        pass


def test_a_hold_lets_no_process_remove_files(files: FileStore) -> None:
    with files.removal_hold.held(), files.removal_hold.free() as is_free:
        assert not is_free
    with files.removal_hold.free() as is_free:
        assert is_free
