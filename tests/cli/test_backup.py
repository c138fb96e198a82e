"""`kinedex backup` copies a library that is in use; the copy is a complete library."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pytest

from app.cli.backup import exit_on_sigterm
from app.demo import DemoClip
from app.store.upkeep.backup import DATABASE, FILES
from tests.cli.conftest import Kinedex
from tests.live import NET_S, serve, wait_until


def test_a_copy_is_a_complete_library(kinedex: Kinedex, tmp_path: Path) -> None:
    copy = tmp_path / "backups" / "monday"
    made = kinedex("backup", str(copy), "--json").json()
    assert made["path"] == str(copy)
    assert made["files"] == 13  # one of them is no motion
    assert made["bytes"] == sum(p.stat().st_size for p in copy.rglob("*") if p.is_file())
    asked = ("search", "--words", "kick", "--limit", "3", "--json")
    ours, theirs = kinedex(*asked).json(), kinedex(*asked, data_dir=copy).json()
    assert ours["items"] == theirs["items"]
    clip = ours["items"][0]["clip"]["id"]
    exported = [tmp_path / "ours.bvh", tmp_path / "theirs.bvh"]
    for path, settings in zip(exported, ({}, {"data_dir": copy}), strict=True):
        assert kinedex("export", clip, "-o", str(path), **settings).code == 0
    assert exported[0].read_bytes() == exported[1].read_bytes()
    assert kinedex("recognize", clip, "--json", data_dir=copy).json()["task"]["label"] == "kick"


@pytest.mark.parametrize("name", ["a?b", "a%20b", "100%"])
def test_paths_may_contain_any_characters(kinedex: Kinedex, tmp_path: Path, name: str) -> None:
    data_dir, copy = tmp_path / f"d {name}", tmp_path / name
    data_dir.mkdir()
    assert kinedex("db", "upgrade", data_dir=data_dir).code == 0
    made = kinedex("backup", str(copy), "--json", data_dir=data_dir).json()
    assert made["path"] == str(copy)
    assert {path.name for path in tmp_path.iterdir()} == {data_dir.name, name}
    assert {path.name for path in copy.iterdir()} == {DATABASE, FILES}
    again = kinedex("db", "upgrade", data_dir=copy)
    assert (again.code, "is at revision" in again.out) == (0, True)


def test_wrong_paths_are_refused(kinedex: Kinedex, tmp_path: Path) -> None:
    again = kinedex("backup", str(tmp_path))
    assert (again.code, again.out) == (1, "")
    assert f"{tmp_path} is there already" in again.err
    nothing = kinedex("backup", str(tmp_path / "copy"), data_dir=tmp_path / "elsewhere")
    assert nothing.code == 1
    assert "There is no library in" in nothing.err
    assert list(tmp_path.iterdir()) == []
    assert kinedex("backup").code == 2


def test_sigterm_raises_an_exception() -> None:
    """The exception removes an incomplete copy. After SIGKILL, the next copy removes it."""
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(SystemExit) as ended, exit_on_sigterm():
        signal.raise_signal(signal.SIGTERM)
    assert ended.value.code == 128 + signal.SIGTERM
    assert signal.getsignal(signal.SIGTERM) == before


def test_a_library_is_not_copied_into_itself(
    kinedex: Kinedex, data_dir: Path, tmp_path: Path
) -> None:
    before = {path.name for path in data_dir.iterdir()}
    (tmp_path / "link").symlink_to(data_dir)
    for path in (
        data_dir / "copy",
        data_dir / "files" / "new" / "copy",
        tmp_path / "link" / "copy",
    ):
        refused = kinedex("backup", str(path))
        assert (refused.code, refused.out) == (1, "")
        assert f"{path} is inside the library" in refused.err
    assert "is there already" in kinedex("backup", str(data_dir)).err
    assert {path.name for path in data_dir.iterdir()} == before


def test_a_library_is_copied_while_the_api_runs(
    kinedex: Kinedex, clips: list[DemoClip], tmp_path: Path
) -> None:
    data_dir, copy = tmp_path / "data", tmp_path / "copy"
    with serve(data_dir) as live:
        for clip in clips[:3]:
            assert live.upload(clip).status_code == 202
        assert kinedex("backup", str(copy), data_dir=data_dir).code == 0
        assert live.upload(clips[3]).status_code == 202
    with serve(copy, worker=True) as restored, restored.client() as client:

        def ready() -> list[dict[str, Any]]:
            found: list[dict[str, Any]] = client.get("/v1/clips?state=ready").json()["items"]
            return found if len(found) == 3 else []

        restored = wait_until(ready, NET_S)  # clips that waited in the library wait in its copy
        assert client.get("/v1/clips?limit=100&state=queued").json()["items"] == []
        contents = {client.get(f"/v1/clips/{clip['id']}/file").content for clip in restored}
        assert contents == {clip.content for clip in clips[:3]}
