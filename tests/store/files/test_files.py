"""The file store: a file is stored completely or not at all."""

from __future__ import annotations

import errno
import hashlib
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from app.errors import BadField, DiskFull, FileDamaged, NotFound, StorageError, TooLarge
from app.store.files import locked_file
from app.store.files.files import FileStore
from app.store.files.hash_check import read_whole
from app.store.files.local_files import LocalFiles


@pytest.fixture
def files(tmp_path: Path) -> FileStore:
    return LocalFiles(tmp_path / "files")


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


def test_content_that_is_not_kept_is_removed(files: FileStore) -> None:
    with files.stage(io.BytesIO(b"walk")):
        pass
    with pytest.raises(RuntimeError), files.stage(io.BytesIO(b"run")):
        raise RuntimeError
    with pytest.raises(TooLarge), files.stage(io.BytesIO(b"jump"), max_bytes=3):
        pass
    assert everything_in(files) == []


def test_content_of_exactly_the_limit_is_accepted(files: FileStore) -> None:
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

    monkeypatch.setattr("app.store.files.staging.os.fsync", fail)
    with pytest.raises(failure), files.stage(io.BytesIO(b"walk")) as staged:
        staged.keep()
    assert everything_in(files) == []


def test_a_really_full_disk(tmp_path: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    files = LocalFiles(tmp_path)

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

    monkeypatch.setattr("app.store.files.staging.os.fsync", spy)
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


def held_by_another_process(files: FileStore) -> subprocess.Popen[str]:
    """A process in the middle of an upload; `line` of its output names the temporary."""
    code = (
        "import io, pathlib, sys\n"
        "from app.store.files.local_files import LocalFiles\n"
        "files = LocalFiles(pathlib.Path(sys.argv[1]))\n"
        "with files.stage(io.BytesIO(b'half')) as staged:\n"
        "    print(staged.temporary, flush=True)\n"
        "    sys.stdin.read()\n"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, str(files.root)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_temporaries_of_dead_uploads_are_removed_at_any_age(files: FileStore) -> None:
    process = held_by_another_process(files)
    try:
        assert process.stdout is not None
        temporary = Path(process.stdout.readline().strip())
        os.utime(temporary, (0, 0))  # old, but its process lives
        with files.stage(io.BytesIO(b"walk")) as own:
            assert files.remove_abandoned_temporaries() == 0
            assert own.temporary.exists()
        assert temporary.exists()
    finally:
        process.kill()
        process.communicate()
    os.utime(temporary, (2**33, 2**33))  # its time is in the future, but its process is dead
    assert files.remove_abandoned_temporaries() == 1
    assert everything_in(files) == []


def test_a_temporary_that_a_sweep_removes_before_its_lock_is_made_again(
    files: FileStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, swept = locked_file._lock, []

    def swept_first(descriptor: int) -> None:
        if not swept:
            swept.append(files.remove_abandoned_temporaries())
        real(descriptor)

    monkeypatch.setattr(locked_file, "_lock", swept_first)
    sha256 = put(files, b"walk")
    assert swept == [1]
    assert files.path(sha256).read_bytes() == b"walk"


def test_files_and_folders_are_private(files: FileStore) -> None:
    before = os.umask(0)
    try:
        put(files, b"walk")
        files.set_aside(put(files, b"run"))
    finally:
        os.umask(before)
    modes = {path: path.stat().st_mode & 0o777 for path in [files.root, *files.root.rglob("*")]}
    assert {mode for path, mode in modes.items() if path.is_dir()} == {0o700}
    assert {mode for path, mode in modes.items() if path.is_file()} == {0o600}


def test_a_damaged_file_is_not_read(files: FileStore) -> None:
    sha256 = put(files, b"walk, walk, walk")
    assert files.checked_path(sha256) == files.path(sha256)
    path = files.path(sha256)
    with path.open("r+b") as file:  # one flipped bit, in place
        file.write(b"v")
    with pytest.raises(FileDamaged, match=sha256):
        files.checked_path(sha256)
    with path.open("rb") as file, pytest.raises(FileDamaged):
        read_whole(file, path.name)
    put(files, b"walk, walk, walk")  # the same bytes repair it
    with files.checked_path(sha256).open("rb") as file:
        assert read_whole(file, sha256) == b"walk, walk, walk"


def test_a_checked_file_is_not_hashed_again_for_each_part(
    files: FileStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    sha256, hashed = put(files, b"song"), []
    monkeypatch.setattr(
        "app.store.files.hash_check.refuse_damage", lambda *names: hashed.append(names)
    )
    for _ in range(5):
        files.checked_path(sha256)
    assert hashed == [(sha256, sha256)]
