"""`kinedex import`: good files, failed files, and files that the library already has."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

from app.api.schemas.jobs import Job
from app.demo import DemoClip, demo_clips
from tests.cli.conftest import ABSENT, BAD, Ended, Kinedex


def test_good_files_are_imported_and_each_failure_is_printed(
    imported: Ended, clips: list[DemoClip], folder: Path
) -> None:
    assert imported.code == 1
    printed = " ".join(imported.out.split())
    count = len(clips)
    counts = f"{count + 2} files: {count} new, 0 updated, 0 unchanged, 1 failed, 1 absent."
    assert counts in printed
    assert f"{BAD} " in printed
    assert f"{ABSENT} The manifest names a file that does not exist." in printed
    assert "Traceback" not in imported.err


def test_the_reason_names_the_line_once(imported: Ended, clips: list[DemoClip]) -> None:
    printed = " ".join(imported.out.split())
    reason = printed.partition(BAD)[2].partition(ABSENT)[0]
    assert reason.count("line ") == 1


def test_the_same_folder_again_adds_nothing(
    kinedex: Kinedex, folder: Path, clips: list[DemoClip]
) -> None:
    ended = kinedex("import", str(folder), "--json")
    assert ended.code == 1
    job = json.loads(ended.out)
    assert Job.model_validate(job).model_dump(mode="json") == job
    result = job["result"]
    counts = [result[name] for name in ("new", "unchanged", "failed", "absent")]
    assert counts == [0, len(clips), 1, 1]
    outcomes = {f["path"]: f["outcome"] for f in result["files"] if f["outcome"] != "unchanged"}
    assert outcomes == {BAD: "failed", ABSENT: "absent"}


def test_a_zip_and_a_single_file_are_imported_too(kinedex_alone: Kinedex, tmp_path: Path) -> None:
    (new,) = demo_clips(["chika"], ["bow"], takes=1)
    file, archive = tmp_path / "bow.bvh", tmp_path / "bow.zip"
    file.write_bytes(new.content)
    with zipfile.ZipFile(archive, "w") as zipped:
        zipped.write(file, "bow.bvh")
    waiting = kinedex_alone("import", str(archive), "--no-wait", "--json").json()
    assert waiting["state"] == "processing"
    job = kinedex_alone("import", str(file), "--json").json()
    assert [f["outcome"] for f in job["result"]["files"]] == ["ready"]


def test_a_missing_path_is_refused(kinedex: Kinedex) -> None:
    ended = kinedex("import", "no/such/folder")
    assert ended.code == 1
    assert "There is no file or folder no/such/folder." in ended.err


def test_db_upgrade_creates_and_upgrades_the_database(kinedex: Kinedex, tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()
    for _ in range(2):
        ended = kinedex("--data-dir", str(tmp_path / "new"), "db", "upgrade")
        assert (ended.code, ended.err) == (0, "")
        assert ended.out.startswith("The database is at revision ")
    assert (tmp_path / "new" / "kinedex.sqlite3").is_file()
