"""Hostile archives: the archive or single entries are refused, and nothing is written to a path."""

from __future__ import annotations

import io
import os
import stat
import zipfile
from pathlib import Path

import pytest

from app.errors import BadField, TooLarge, Unreadable
from app.services.imports.archive_directory import HEADER_BYTES
from app.services.imports.skipped import NoMotion
from app.services.imports.sources import (
    ArchiveLimits,
    SourceFile,
    archive_files,
    folder_files,
    is_archive,
    single_file,
)
from tests.zip_archives import zip_archive

LIMITS = ArchiveLimits(entries=5, ratio=50.0, file_bytes=20 * 2**20)


def _files(archive: io.BytesIO, limits: ArchiveLimits = LIMITS) -> list[SourceFile]:
    with archive_files(archive, limits) as files:
        return files


def test_files_are_read_in_the_archives_order() -> None:
    with archive_files(zip_archive({"b/x.bvh": b"1", "a.bvh": b"22"}), LIMITS) as files:
        assert [(f.path, f.open().read(), f.problem) for f in files] == [
            ("b/x.bvh", b"1", None),
            ("a.bvh", b"22", None),
        ]


def test_folders_and_hidden_files_are_ignored() -> None:
    names = ["d/", "__MACOSX/a.bvh", ".DS_Store", ".git/config", "d/a.bvh"]
    assert [f.path for f in _files(zip_archive(dict.fromkeys(names, b"")))] == ["d/a.bvh"]


@pytest.mark.parametrize(
    "name", ["/etc/a.bvh", "../a.bvh", "d/../../a.bvh", "C:/a.bvh", "..\\a.bvh"]
)
def test_a_path_out_of_the_archive_is_refused(name: str) -> None:
    (file,) = _files(zip_archive({name: b"x"}))
    assert file.problem is not None
    assert "out of the archive" in file.problem.detail


def test_a_link_is_refused() -> None:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        link = zipfile.ZipInfo("a.bvh")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
    (file,) = _files(made)
    assert file.problem is not None
    assert "Links" in file.problem.detail


def test_an_encrypted_entry_is_refused() -> None:
    content = bytearray(zip_archive({"a.bvh": b"x"}).getvalue())
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        content[content.index(signature) + offset] |= 1
    (file,) = _files(io.BytesIO(bytes(content)))
    assert file.problem is not None
    assert "encrypted" in file.problem.detail


def test_a_too_large_file_is_refused_alone() -> None:
    limits = ArchiveLimits(5, 50.0, file_bytes=3)
    small, large = _files(zip_archive({"a": b"123", "b": b"1234"}), limits)
    assert small.problem is None
    assert isinstance(large.problem, TooLarge)


def test_a_zip_bomb_is_refused() -> None:
    with pytest.raises(TooLarge, match="unpacked archive is too large"):
        _files(zip_archive({"a": bytes(15 * 2**20)}))


def test_an_archive_with_too_many_entries_is_refused() -> None:
    with pytest.raises(TooLarge, match="too many files"):
        _files(zip_archive({str(i): b"" for i in range(6)}))


def test_a_directory_of_too_many_entries_is_refused_before_it_is_read_whole() -> None:
    few = zip_archive(dict.fromkeys([f".hidden/{i}" for i in range(15)], b""))
    assert _files(few) == []
    many = zip_archive(dict.fromkeys([f".hidden/{i}" for i in range(16)], b""))
    read: list[int] = []

    class Watched(io.BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            content = super().read(size)
            read.append(len(content))
            return content

    with pytest.raises(TooLarge, match="too many files") as refused:
        _files(Watched(many.getvalue()))
    assert refused.value.places[0].message.startswith("more than 15 entries")
    assert max(read) < 16 * HEADER_BYTES


def test_a_directory_of_too_long_names_is_refused() -> None:
    names = [f"{i}/".ljust(60_000, "x") for i in range(4)]
    assert len(_files(zip_archive(dict.fromkeys(names, b"")))) == 4
    names = [f"{i}/".ljust(65_000, "x") for i in range(12)]
    with pytest.raises(TooLarge) as refused:
        _files(zip_archive(dict.fromkeys(names, b"")), ArchiveLimits(20, 50.0, 100))
    assert "bytes of names" in refused.value.places[0].message


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 and then nothing", b"HIERARCHY"])
def test_content_that_is_no_archive_is_unreadable(content: bytes) -> None:
    with pytest.raises(Unreadable):
        _files(io.BytesIO(content))


def test_a_truncated_archive_is_unreadable() -> None:
    whole = zip_archive({"a.bvh": b"x" * 1000}, zipfile.ZIP_STORED).getvalue()
    with pytest.raises(Unreadable):
        _files(io.BytesIO(whole[: len(whole) // 2]))


def test_folders_and_single_files_are_sources(tmp_path: Path) -> None:
    for name in ("b/y.bvh", "a.bvh", ".hidden/x.bvh", ".x"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(name.encode())
    files = folder_files(tmp_path)
    assert [f.path for f in files] == ["a.bvh", "b/y.bvh"]
    with files[1].open() as file:
        assert file.read() == b"b/y.bvh"
    assert [f.path for f in single_file(tmp_path / "a.bvh")] == ["a.bvh"]
    assert not is_archive(tmp_path / "a.bvh")
    (tmp_path / "z.zip").write_bytes(zip_archive({"a": b""}).getvalue())
    assert is_archive(tmp_path / "z.zip")


def test_libraries_below_a_folder_are_left_out(tmp_path: Path) -> None:
    for name in ("a.bvh", "data/kinedex.sqlite3", "data/files/ab/x", "own/files/cd/y"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(b"1")
    motion, *libraries = folder_files(tmp_path, tmp_path / "own")
    assert (motion.path, motion.problem) == ("a.bvh", None)
    assert [library.path for library in libraries] == ["data", "own"]
    assert all(isinstance(library.problem, NoMotion) for library in libraries)
    for inside in ("data", "own", "own/files"):
        with pytest.raises(BadField, match="folder of a library"):
            folder_files(tmp_path / inside, tmp_path / "own")


@pytest.mark.parametrize("name", ["deflated", "bzip2", "lzma", "stored"])
def test_only_the_damaged_entry_is_unreadable(name: str) -> None:
    compressions = {
        "deflated": zipfile.ZIP_DEFLATED,
        "bzip2": zipfile.ZIP_BZIP2,
        "lzma": zipfile.ZIP_LZMA,
        "stored": zipfile.ZIP_STORED,
    }
    noise = bytes(range(256)) * 20
    content = bytearray(
        zip_archive({"bad.bvh": noise, "good.bvh": b"1"}, compressions[name]).getvalue()
    )
    for place in range(60, 100):
        content[place] ^= 0x5A
    with archive_files(io.BytesIO(bytes(content)), LIMITS) as (bad, good):
        with pytest.raises(Unreadable), bad.open() as file:
            file.read()
        assert good.open().read() == b"1"


def test_a_pipe_is_refused_without_waiting_for_a_writer(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.bvh")
    (tmp_path / "dangling.bvh").symlink_to(tmp_path / "nowhere")
    for file in folder_files(tmp_path):
        with pytest.raises(Unreadable):
            file.open()
