"""`kinedex verify` and `kinedex db adopt-files`; and starts that are refused."""

from __future__ import annotations

import shutil
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from app.store.upkeep.backup import DATABASE
from tests.cli.conftest import Kinedex, end, start


@pytest.fixture
def copied(imported: object, data_dir: Path, tmp_path: Path) -> Path:
    """A copy of the library that a test may damage."""
    return Path(shutil.copytree(data_dir, tmp_path / "data"))


def stored(folder: Path) -> list[Path]:
    return sorted(path for path in (folder / "files").rglob("*") if len(path.name) == 64)


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def test_an_undamaged_library_passes(kinedex: Kinedex, data_dir: Path) -> None:
    result = kinedex("verify", "--json").json()
    assert result["is_whole"]
    assert result["files"] == len(stored(data_dir))
    assert result["arrays"] > 100
    assert "The library is complete and undamaged." in kinedex("verify").out


def test_damaged_and_missing_files_are_named(kinedex: Kinedex, copied: Path) -> None:
    damaged, lost, *_ = stored(copied)
    flip(damaged)
    lost.unlink()
    found = kinedex("verify", data_dir=copied)
    assert found.code == 1
    assert f"damaged file: {damaged.name}" in found.out
    assert f"missing file: {lost.name}" in found.out
    assert "The library is damaged." in found.out
    assert kinedex("verify", "--json", data_dir=copied).code == 1
    backup = kinedex("backup", str(copied.parent / "copy"), data_dir=copied)
    assert backup.code == 1
    assert {damaged.name, lost.name} <= set(backup.err.replace(":", " ").split())


def overwrite(copied: Path) -> None:
    path = copied / DATABASE
    with path.open("r+b") as file:
        for page in range(3, path.stat().st_size // 4096, 7):
            file.seek(page * 4096)
            file.write(b"\xa5" * 4096)


def test_a_damaged_database_is_reported(kinedex: Kinedex, copied: Path) -> None:
    overwrite(copied)
    for command in (("verify",), ("backup", str(copied.parent / "copy"))):
        found = kinedex(*command, data_dir=copied)
        assert found.code == 1
        assert "damage" in found.out + found.err
    assert [path.name for path in copied.parent.iterdir()] == [copied.name]


def test_a_missing_library_is_refused(kinedex: Kinedex, tmp_path: Path) -> None:
    found = kinedex("verify", data_dir=tmp_path / "nothing")
    assert (found.code, "There is no library" in found.err) == (1, True)
    assert list(tmp_path.iterdir()) == []


def move_database(copied: Path) -> dict[str, object]:
    for path in copied.glob("kinedex.sqlite3*"):
        path.rename(copied.parent / path.name)
    return {}


def mistype_database(copied: Path) -> dict[str, object]:
    return {"database_url": f"sqlite:///{copied}/kinedx.sqlite3"}


@pytest.mark.parametrize("harm", [move_database, mistype_database])
@pytest.mark.parametrize("command", ["serve", "worker", "db", "keys"])
def test_a_start_without_its_database_is_refused_and_deletes_nothing(
    copied: Path, harm: Callable[[Path], dict[str, object]], command: str
) -> None:
    before = stored(copied)
    settings = harm(copied)
    words = {"db": ("db", "upgrade"), "keys": ("keys", "list")}.get(command, (command,))
    found = end(start(*words, data_dir=copied, **settings))
    assert found.code == 1
    assert "There is no library in" in found.err
    assert "put it back" in found.err
    assert before
    assert stored(copied) == before
    assert not [path for path in copied.iterdir() if "kinedx" in path.name]


def test_only_adopt_files_connects_files_to_another_database(
    kinedex: Kinedex, copied: Path
) -> None:
    other = copied.parent / "other"
    other.mkdir()
    assert kinedex("db", "upgrade", data_dir=other).code == 0
    shutil.copy(other / DATABASE, copied / DATABASE)
    refused = kinedex("keys", "list", data_dir=copied)
    assert (refused.code, "kinedex db adopt-files" in refused.err) == (1, True)
    files = len(stored(copied))
    adopted = kinedex("db", "adopt-files", data_dir=copied)
    assert (adopted.code, f"{files} other files to the quarantine" in adopted.out) == (0, True)
    assert kinedex("keys", "list", data_dir=copied).code == 0
    assert len(stored(copied)) == files


def test_a_new_data_directory_is_private_to_its_owner(
    kinedex: Kinedex, folder: Path, tmp_path: Path
) -> None:
    made, file = tmp_path / "made", folder / "ada" / "walk_01.bvh"
    assert kinedex("import", str(file), "--no-wait", data_dir=made).code == 0
    assert stat.S_IMODE(made.stat().st_mode) == 0o700
