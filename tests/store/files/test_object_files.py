"""Files in a bucket: what is special about them."""

from __future__ import annotations

import hashlib
import io
import os
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from app.errors import ConfigurationError, FileDamaged, NotFound, StorageError
from app.store.files import copies, object_quarantine
from app.store.files.bucket import Bucket
from app.store.files.files import FileStore, name_of
from app.store.files.object_quarantine import ObjectQuarantine
from app.store.files.objects import ObjectInfo, Objects
from app.store.files.places import open_files
from tests.buckets import Buckets

DAY_S = 24 * 3600.0


@pytest.fixture
def bucket(s3: Buckets, tmp_path: Path) -> Bucket:
    return s3.new(tmp_path / "files")


@pytest.fixture
def files(bucket: Bucket) -> FileStore:
    return open_files(bucket)


def put(files: FileStore, content: bytes) -> str:
    with files.stage(io.BytesIO(content)) as staged:
        staged.keep()
    return staged.sha256


def test_a_copy_of_the_bucket_is_a_folder_of_files(
    s3: Buckets, bucket: Bucket, files: FileStore, tmp_path: Path
) -> None:
    files.write_id("library_one")
    walk, run = put(files, b"walk"), put(files, b"run")
    files.set_aside(run)
    copy = tmp_path / "copy"
    for name in s3.names(bucket):
        path = copy / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(s3.read(bucket, name))
    folder = open_files(copy, "library_one")
    folder.check_identity()
    assert folder.path(walk).read_bytes() == b"walk"
    assert folder.path(run).read_bytes() == b"run"


def test_a_store_that_does_not_keep_the_bytes_is_noticed_before_the_row(
    s3: Buckets, bucket: Bucket, files: FileStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Objects.upload

    def flipped(objects: Objects, name: str, path: Path) -> None:
        real(objects, name, path)
        s3.write(bucket, name, b"walc")

    monkeypatch.setattr(Objects, "upload", flipped)
    with (
        pytest.raises(StorageError, match="does not hold the bytes"),
        files.stage(io.BytesIO(b"walk")),
    ):
        pytest.fail("the bytes count as staged")
    assert s3.names(bucket) == []


def test_the_same_bytes_repair_a_damaged_object(
    s3: Buckets, bucket: Bucket, files: FileStore
) -> None:
    walk = put(files, b"walk")
    s3.write(bucket, name_of(walk), b"walc")
    with pytest.raises(FileDamaged):
        files.check(walk)
    put(files, b"walk")
    files.check(walk)


def test_bytes_that_the_bucket_has_are_not_sent_again(
    files: FileStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    walk = put(files, b"walk")
    monkeypatch.setattr(Objects, "upload", lambda *_: pytest.fail("sent"))
    assert put(files, b"walk") == walk


def test_a_file_that_is_removed_while_it_is_stored_again_is_kept(files: FileStore) -> None:
    walk = put(files, b"walk")
    with files.stage(io.BytesIO(b"walk")) as staged:
        files.remove(walk)
        staged.keep()
    files.check(walk)


def test_a_damaged_object_is_not_read_and_a_damaged_copy_is_replaced(
    s3: Buckets, bucket: Bucket, files: FileStore, tmp_path: Path
) -> None:
    walk = put(files, b"walk, walk")
    (tmp_path / "files" / copies.FOLDER / walk).write_bytes(b"walk, wolk")
    assert files.checked_path(walk).read_bytes() == b"walk, walk"
    s3.write(bucket, name_of(walk), b"wolk, walk")
    other = open_files(replace(bucket, folder=tmp_path / "other"))
    with pytest.raises(FileDamaged):
        other.path(walk)
    assert walk in other.suspects
    assert list((tmp_path / "other").rglob("*/*")) == []


def test_copies_on_another_machine_go_with_the_file(
    bucket: Bucket, files: FileStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    walk = put(files, b"walk")
    other = open_files(replace(bucket, folder=tmp_path / "other"))
    assert other.path(walk).read_bytes() == b"walk"
    files.remove(walk)
    monkeypatch.setattr(copies, "KEPT_S", 0.0)
    assert other.missing([walk]) == {walk}
    assert not [path for path in (tmp_path / "other").rglob("*") if path.is_file()]
    with pytest.raises(NotFound):
        other.path(walk)


def test_copies_keep_within_their_size(
    s3: Buckets, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(copies, "KEPT_S", 0.0)
    files = open_files(s3.new(tmp_path / "small", cache_bytes=25))
    names = [put(files, bytes([number]) * 10) for number in range(4)]
    folder = tmp_path / "small" / copies.FOLDER
    assert sum(path.stat().st_size for path in folder.iterdir()) <= 25
    assert [files.path(name).read_bytes()[0] for name in names] == [0, 1, 2, 3]


def test_old_temporary_objects_are_removed(
    s3: Buckets, bucket: Bucket, files: FileStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    s3.write(bucket, "tmp/up_dead", b"half")
    assert files.remove_abandoned_temporaries() == 0
    monkeypatch.setattr("app.store.files.object_files.ABANDONED_S", -60.0)
    assert files.remove_abandoned_temporaries() == 1
    assert s3.names(bucket) == []


class _Clock:
    """A store whose clock stands where the test sets it."""

    def __init__(self) -> None:
        self.now = 1e9
        self.objects: dict[str, tuple[bytes, float]] = {}

    def replace(self, name: str, content: bytes) -> None:
        self.objects[name] = (content, self.now)

    def read(self, name: str) -> Iterator[bytes]:
        yield self.objects[name][0]

    def remove(self, name: str) -> None:
        self.objects.pop(name, None)

    def find(self, name: str) -> ObjectInfo | None:
        return self._info(name) if name in self.objects else None

    def below(self, folder: str = "") -> Iterator[ObjectInfo]:
        return (self._info(name) for name in list(self.objects))

    def _info(self, name: str) -> ObjectInfo:
        content, time = self.objects[name]
        return ObjectInfo(name, len(content), datetime.fromtimestamp(time, UTC))


@pytest.mark.parametrize("jump_days", [40.0, -40.0])
def test_a_jump_of_the_stores_clock_purges_nothing_too_early(jump_days: float) -> None:
    store = _Clock()
    quarantine = ObjectQuarantine(store, "bucket")  # type: ignore[arg-type]
    sha256 = hashlib.sha256(b"walk").hexdigest()
    store.replace(f"{object_quarantine.FOLDER}/{sha256}", b"walk")
    for _ in range(20):
        assert quarantine.purge(30 * DAY_S) == ()
        store.now += DAY_S / 2
    store.now += jump_days * DAY_S
    for _ in range(60):
        assert quarantine.purge(30 * DAY_S) == ()
        store.now += DAY_S / 2
    for _ in range(45 * 2):
        store.now += DAY_S / 2
        if quarantine.purge(30 * DAY_S):
            return
    pytest.fail("it stays for ever")


def test_a_store_that_does_not_answer_is_a_failure_of_the_store(
    bucket: Bucket, monkeypatch: pytest.MonkeyPatch
) -> None:
    from datetime import timedelta

    monkeypatch.setattr("app.store.files.objects.RETRY_S", timedelta(seconds=0.1))
    files = open_files(replace(bucket, endpoint="http://127.0.0.1:9"))
    for ask in (files.read_id, lambda: list(files), lambda: files.has("0" * 64)):
        with pytest.raises(StorageError, match="bucket of files failed"):
            ask()
    absent = open_files(replace(bucket, url="s3://there-is-none/x"))
    with pytest.raises(StorageError), absent.stage(io.BytesIO(os.urandom(9))):
        pass


@pytest.mark.parametrize("url", ["file:///tmp", "https://host/bucket", "s3://", "bucket"])
def test_urls_that_name_no_bucket(bucket: Bucket, url: str) -> None:
    with pytest.raises(ConfigurationError):
        open_files(replace(bucket, url=url))
