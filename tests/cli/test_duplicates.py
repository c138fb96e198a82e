"""Near-duplicates on the command line."""

from __future__ import annotations

import io
import threading
from pathlib import Path

from app.config import Settings
from app.demo import demo_clips
from app.formats.npz.writer import write_npz
from app.services.clips import catalogue as clips
from app.services.curation import comparison
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.worker.loop import run_worker
from tests.cli.conftest import Kinedex


def test_groups_are_listed_with_their_keeper(kinedex: Kinedex) -> None:
    assert kinedex("duplicates", "--json").json() == {"items": []}
    assert "No near-duplicates" in kinedex("duplicates").out
    original, copy = _library_with_copy(kinedex.data_dir)
    (group,) = kinedex("duplicates", "--json").json()["items"]
    assert {one["id"] for one in group["clips"]} == {original, copy}
    assert group["pairs"][0]["kind"] == "cut"
    shown = kinedex("duplicates").out
    assert group["id"] in shown
    assert next(line for line in shown.splitlines() if "keep" in line).split()[1] == original
    rows = kinedex("duplicates", "--csv").out.splitlines()
    assert rows[0].startswith("group,keeper,clip_id,other_id,kind,distance")
    assert rows[1].startswith(f"{group['id']},{original},")


def _library_with_copy(data_dir: Path) -> tuple[str, str]:
    lib = Library.open(Settings(data_dir=data_dir, analysis_processes=1))
    (walk,) = demo_clips(["ada"], ["walk"], takes=1)
    original = clips.create_clip(lib, io.BytesIO(walk.content), "walk.bvh").clip.id
    run_worker(lib.settings, threading.Event(), until=lambda _: True)
    motion = load_motion(lib, clips.get_clip(lib, original))
    content = write_npz(
        motion.names, motion.parents, motion.positions[motion.frames // 4 :], motion.frame_rate
    )
    copy = clips.create_clip(lib, io.BytesIO(content), "copy.npz").clip.id
    run_worker(lib.settings, threading.Event(), until=lambda _: True)
    for _ in comparison.compare_pending(lib):
        pass
    lib.close()
    return original, copy
