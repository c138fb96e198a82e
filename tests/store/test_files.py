"""The file store: whole or not at all."""

from __future__ import annotations

import errno
import hashlib
import io
import os
from pathlib import Path
from typing import Any

import pytest

from app.errors import BadField, DiskFull, NotFound, StorageError, TooLarge
from app.store import clips, jobs
from app.store.files import FileStore
from app.store.job_record import JobKind, NewJob
from app.store.store import Store
from tests.store.conftest import AddClip


@pytest.fixture
def files(tmp_path: Path) -> FileStore:
    return FileStore(tmp_path / "files")


def put(files: FileStore, content: bytes) -> str:
    with files.stage(io.BytesIO(content)) as staged:
        staged.keep()
    return staged.sha256


def everything_in(files: FileStore) -> list[Path]:
    return [path for path in files.root.rglob("*") if path.is_file()]


def test_kept_content_is_found_by_its_hash(files: FileStore) -> None:
    content = os.urandom(3 * 1024 * 1024 + 17)
    with files.stage(io.BytesIO(content)) as staged:
        with staged.open() as file:
            assert file.read(3) == content[:3]
        staged.keep()
    assert staged.sha256 == hashlib.sha256(content).hexdigest()
    assert staged.size == len(content)
    with files.open(staged.sha256) as file:
        assert file.read() == content
    assert files.path(staged.sha256).parent.parent.name == staged.sha256[:2]
    assert everything_in(files) == [files.path(staged.sha256)]


def test_the_same_bytes_are_kept_once(files: FileStore) -> None:
    assert put(files, b"walk") == put(files, b"walk")
    assert len(everything_in(files)) == len(list(files)) == 1


def test_what_is_not_kept_leaves_nothing(files: FileStore) -> None:
    with files.stage(io.BytesIO(b"walk")):
        pass
    with pytest.raises(RuntimeError), files.stage(io.BytesIO(b"run")):
        raise RuntimeError
    with pytest.raises(TooLarge), files.stage(io.BytesIO(b"jump"), max_bytes=3):
        pass
    assert everything_in(files) == []


def test_content_of_exactly_the_limit_is_taken(files: FileStore) -> None:
    with files.stage(io.BytesIO(b"jump"), max_bytes=4) as staged:
        assert staged.size == 4


@pytest.mark.parametrize(
    ("code", "failure"), [(errno.ENOSPC, DiskFull), (errno.EDQUOT, DiskFull), (5, StorageError)]
)
def test_a_disk_that_fails_leaves_nothing(
    files: FileStore,
    monkeypatch: pytest.MonkeyPatch,
    code: int,
    failure: type[StorageError],
) -> None:
    def fail(_descriptor: int) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr("app.store.files.os.fsync", fail)
    with pytest.raises(failure), files.stage(io.BytesIO(b"walk")) as staged:
        staged.keep()
    assert everything_in(files) == []


def test_a_really_full_disk(tmp_path: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    files = FileStore(tmp_path)

    class Full(io.BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            with Path("/dev/full").open("wb", buffering=0) as full:
                full.write(b"x")
            return b""

    with pytest.raises(DiskFull), files.stage(Full()):
        pass
    assert everything_in(files) == []


def test_content_and_directories_are_synced_before_it_counts_as_kept(
    files: FileStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[str] = []
    real = os.fsync

    def spy(descriptor: int) -> None:
        synced.append(str(Path(f"/proc/self/fd/{descriptor}").readlink()))
        real(descriptor)

    monkeypatch.setattr("app.store.files.os.fsync", spy)
    sha256 = put(files, b"walk")
    final = files.path(sha256)
    temporary = next(n for n, path in enumerate(synced) if "/tmp/up_" in path)
    assert synced[-1] == str(final.parent)
    assert temporary < len(synced) - 1
    parents = {final.parent.parent, files.root, files.root.parent}
    assert {str(path) for path in parents} <= set(synced)


def test_missing_and_malformed_names(files: FileStore) -> None:
    with pytest.raises(NotFound):
        files.open("0" * 64)
    for name in ("", "../../etc/passwd", "A" * 64, "0" * 63 + "\n"):
        with pytest.raises(BadField):
            files.path(name)
    files.remove("0" * 64)


def test_only_stale_temporaries_are_removed(files: FileStore) -> None:
    put(files, b"walk")
    stale, fresh = files.root / "tmp" / "up_stale", files.root / "tmp" / "up_fresh"
    for path in (stale, fresh):
        path.write_bytes(b"x")
    os.utime(stale, (0, 0))
    assert files.remove_stale_temporaries() == 1
    assert fresh.exists()
    assert not stale.exists()


def test_files_go_when_nothing_refers_to_them(store: Store, add_clip: AddClip) -> None:
    kept = put(store.files, b"kept")
    skeleton = put(store.files, b"skeleton")
    archive = put(store.files, b"archive")
    orphan = put(store.files, b"orphan")
    with store.write() as tx:
        fields: dict[str, Any] = {"file_name": "k.amc", "file_size": 4, "name": "k"}
        new = clips.NewClip(sha256=kept, skeleton_sha256=skeleton, **fields)
        clip = clips.add_or_get(tx, new).clip
        jobs.enqueue(tx, NewJob(JobKind.IMPORT, file_sha256=archive))
    store.drop_unreferenced([kept, skeleton, archive])
    assert set(store.files) == {kept, skeleton, archive, orphan}
    assert store.sweep_files() == 1
    assert set(store.files) == {kept, skeleton, archive}
    with store.write() as tx:
        clips.delete_clip(tx, clip.id)
    store.drop_unreferenced([kept, skeleton])
    assert set(store.files) == {archive}
