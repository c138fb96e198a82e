"""`kinedex collections` and `kinedex searches`."""

from __future__ import annotations

import zipfile
from pathlib import Path

from tests.cli.conftest import Kinedex

USAGE = 2


def test_collections_by_command(kinedex: Kinedex, tmp_path: Path) -> None:
    clips = kinedex("clips", "list", "--task", "walk", "--json").json()["items"]
    first = clips[0]["id"]
    made = kinedex(
        "collections", "create", "walks", f"{first}:0.2:0.8", "--filter", '{"task": "kick"}',
        "--notes", "for tests", "--json",
    ).json()  # fmt: skip
    added = kinedex("collections", "add", made["id"], "--like", first, "--limit", "2", "--json")
    assert added.json()["size"] == made["size"] + 2
    shown = kinedex("collections", "show", made["id"], "--json").json()
    assert (shown["items"][0]["start"], shown["items"][0]["end"]) == (0.2, 0.8)
    last = shown["items"][-1]["id"]
    assert kinedex("collections", "order", made["id"], last).code == 0
    again = kinedex("collections", "show", made["id"], "--json").json()
    assert again["items"][0]["id"] == last
    assert "walks" in kinedex("collections", "list").out
    assert kinedex("collections", "remove", made["id"], last).code == 0
    assert "other" in kinedex("collections", "change", made["id"], "--name", "other").out
    path = tmp_path / "c.zip"
    assert (
        kinedex("collections", "export", made["id"], "-o", str(path), "--format", "npz").code == 0
    )
    assert zipfile.ZipFile(path).testzip() is None
    statistics = kinedex("collections", "statistics", made["id"])
    assert "covered cells" in statistics.out
    assert kinedex("collections", "add", made["id"]).code == USAGE
    assert kinedex("collections", "add", made["id"], "clip:a:b").code == USAGE
    assert kinedex("collections", "delete", made["id"], "--yes").code == 0


def test_searches_by_command(kinedex: Kinedex) -> None:
    (clip,) = kinedex("clips", "list", "--task", "walk", "--limit", "1", "--json").json()["items"]
    saved = kinedex(
        "searches", "save", "walks", "--like", clip["id"], "--limit", "3", "--json"
    ).json()
    hits = kinedex("searches", "run", saved["id"], "--json").json()["items"]
    assert [hit["rank"] for hit in hits] == [1, 2, 3]
    assert kinedex("searches", "new", saved["id"], "--seen", "--json").json()["items"] == []
    assert "walks" in kinedex("searches", "list").out
    assert kinedex("searches", "rename", saved["id"], "mine").code == 0
    assert "mine" in kinedex("searches", "list", "--csv").out
    assert "is deleted" in kinedex("searches", "delete", saved["id"]).out
