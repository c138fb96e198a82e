"""Commands against a service elsewhere: keys, uploads, exports and commands that cannot do it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli.commands import NEEDS_THIS_MACHINE
from app.demo import DemoClip, demo_clips
from tests.cli.conftest import Kinedex
from tests.formats.acclaim.files import acclaim_person
from tests.live import Live, serve


def _write(folder: Path, clips: list[DemoClip]) -> None:
    lines = ["path,person,task"]
    for clip in clips:
        (folder / clip.path).parent.mkdir(parents=True, exist_ok=True)
        (folder / clip.path).write_bytes(clip.content)
        lines.append(f"{clip.path},{clip.person},{clip.task}")
    (folder / "manifest.csv").write_text("\n".join(lines))


def test_a_folder_is_imported_with_its_manifest(
    kinedex: Kinedex, demo_service: Live, tmp_path: Path
) -> None:
    new = list(demo_clips(["dele"], ["bow", "kick"], takes=1))
    _write(tmp_path, new)
    (tmp_path / "broken.bvh").write_bytes(new[0].content[:2000])
    ended = kinedex("import", str(tmp_path), "--url", demo_service.url)
    assert ended.code == 1
    assert "3 files: 2 new, 0 updated, 0 unchanged, 1 failed." in ended.out
    assert "broken.bvh" in ended.out
    url = ("--url", demo_service.url)
    clips = kinedex("clips", "list", "--person", "dele", "--json", *url).json()["items"]
    assert sorted(clip["task"] for clip in clips) == ["bow", "kick"]
    exported = tmp_path / "out.bvh"
    assert kinedex("export", clips[0]["id"], "-o", str(exported), *url).code == 0
    assert exported.read_bytes().startswith(b"HIERARCHY")
    assert kinedex("clips", "delete", *(c["id"] for c in clips), "--yes", *url).code == 0


def test_a_single_file_and_nothing(kinedex: Kinedex, demo_service: Live, tmp_path: Path) -> None:
    (new,) = demo_clips(["farid"], ["bow"], takes=1)
    file = tmp_path / "single.bvh"
    file.write_bytes(new.content)
    url = ("--url", demo_service.url)
    assert "in the library" in kinedex("import", str(file), *url).out
    assert "already has" in kinedex("import", str(file), *url).out
    (clip,) = kinedex("clips", "list", "-q", "single", "--json", *url).json()["items"]
    kinedex("clips", "delete", clip["id"], "--yes", *url)
    missing = kinedex("import", str(tmp_path / "nosuch"), *url)
    assert missing.code == 1
    assert "There is no file or folder" in missing.err


def test_an_amc_file_takes_the_skeleton_beside_it(
    kinedex: Kinedex, demo_service: Live, tmp_path: Path
) -> None:
    skeleton, content, _ = acclaim_person(frames=60, seed=9)
    (tmp_path / "91.asf").write_bytes(skeleton)
    motion = tmp_path / "91_07.amc"
    motion.write_bytes(content)
    url = ("--url", demo_service.url)
    assert kinedex("search", str(motion), "--limit", "1", *url).code == 0
    assert kinedex("import", str(motion), *url).out == "The clip is in the library.\n"
    (clip,) = kinedex("clips", "list", "-q", motion.stem, "--json", *url).json()["items"]
    assert kinedex("clips", "delete", clip["id"], "--yes", *url).code == 0


def test_the_pose_of_a_file_is_found(kinedex: Kinedex, demo_service: Live, folder: Path) -> None:
    file = str(folder / "ada" / "kick_01.bvh")
    asked = ("search-pose", file, "--time", "0.8", "--limit", "2", "--json")
    found = kinedex(*asked, "--url", demo_service.url).json()
    assert [hit["rank"] for hit in found["items"]] == [1, 2]


def test_exports_are_those_of_the_library(
    kinedex: Kinedex, demo_service: Live, tmp_path: Path
) -> None:
    url = ("--url", demo_service.url)
    walks = kinedex("clips", "list", "--task", "walk", "--limit", "2", "--json", *url).json()
    ids = [clip["id"] for clip in walks["items"]]
    for words in (("--fps", "10"), ("--content", "gait"), ("--dimensions", "2"), ("--unit", "m")):
        names = []
        for source in (url, ("--data-dir", str(demo_service.data_dir))):
            folder = tmp_path / "-".join((*words, source[0]))
            folder.mkdir()
            assert kinedex("export", ids[0], "-o", str(folder), *words, *source).code == 0
            (file,) = folder.iterdir()
            names.append((file.name, file.read_bytes()))
        assert names[0] == names[1]
    many = kinedex("export", "clip_none", *ids, "-o", str(tmp_path / "many"), "--json", *url).json()
    assert [one["clip_id"] for one in many["files"]] == ids
    assert [one["clip_id"] for one in many["left_out"]] == ["clip_none"]
    chosen = ("--filter", '{"task": "walk", "meta.nosuch": 1}', "-o", str(tmp_path / "none"))
    assert kinedex("export", *chosen, *url).code == 1
    refused = kinedex(
        "export",
        *ids,
        "--unit",
        "m",
        "--format",
        "csv",
        "--content",
        "segments",
        "--fps",
        "10",
        "-o",
        str(tmp_path / "bad"),
        *url,
    )
    assert (refused.code, "fps: must be left out" in refused.err) == (1, True)


def test_a_service_with_keys(kinedex: Kinedex, tmp_path: Path) -> None:
    data_dir = tmp_path / "data"
    with serve(data_dir) as live:
        made = {
            role: kinedex("keys", "create", "--role", role, "--json", data_dir=data_dir).json()
            for role in ("read", "write")
        }
        refused = kinedex("clips", "list", url=live.url)
        assert refused.code == 1
        assert refused.err.splitlines()[0] == "kinedex: An API key is needed"
        assert "--api-key" in refused.err
        read = {"url": live.url, "api_key": made["read"]["key"]}
        assert kinedex("clips", "list", "--json", **read).json() == {"items": []}
        assert "write" in kinedex("fit", **read).err
        write = ("--url", live.url, "--api-key", made["write"]["key"])
        assert kinedex("clips", "list", *write).code == 0
        checks = json.loads(kinedex("doctor", "--json", url=live.url).out)
        assert not checks["is_healthy"]
        assert {check["check"] for check in checks["checks"] if check["level"] == "problem"} == {
            "key"
        }
        # the user of the machine needs no key
        assert kinedex("clips", "list", "--json", data_dir=data_dir).json() == {"items": []}


@pytest.mark.parametrize("name", sorted(NEEDS_THIS_MACHINE))
def test_commands_for_this_machine_say_so(name: str, kinedex: Kinedex) -> None:
    ended = kinedex(name, "x", url="http://127.0.0.1:1")
    assert (ended.code, ended.out) == (1, "")
    assert f"`kinedex {name}` works on the library of this machine" in ended.err


def test_a_service_that_is_not_there(kinedex: Kinedex) -> None:
    for words in (("clips", "list"), ("doctor",)):
        ended = kinedex(*words, url="http://127.0.0.1:1")
        assert ended.code == 1
        assert "127.0.0.1:1 cannot be reached" in ended.err + ended.out
