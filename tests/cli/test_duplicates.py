"""Near-duplicates on the command line."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest

from app.demo import demo_clips
from app.formats.npz.writer import write_npz
from app.services.clips import catalogue as clips
from app.services.curation import comparison
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from tests.cli.in_process import running
from tests.libraries import settings_for, upload, work


def test_groups_are_listed_with_their_keeper(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lib = Library.open(settings_for(tmp_path))
    run = running("duplicates", lib, tmp_path, monkeypatch)
    assert "No near-duplicates" in run().output
    original, copy = _with_copy(lib)
    (group,) = json.loads(run("--json").output)["items"]
    assert {one["id"] for one in group["clips"]} == {original, copy}
    assert group["pairs"][0]["kind"] == "cut"
    shown = run().output
    assert group["id"] in shown
    assert next(line for line in shown.splitlines() if "keep" in line).split()[1] == original
    rows = run("--csv").output.splitlines()
    assert rows[0].startswith("group,keeper,clip_id,other_id,kind,distance")
    assert rows[1].startswith(f"{group['id']},{original},")
    lib.close()


def _with_copy(lib: Library) -> tuple[str, str]:
    (walk,) = demo_clips(["ada"], ["walk"], takes=1)
    original = upload(lib, walk).clip.id
    work(lib.settings)
    motion = load_motion(lib, clips.get_clip(lib, original))
    positions = motion.positions[motion.frames // 4 :]
    content = write_npz(motion.names, motion.parents, positions, motion.frame_rate)
    copy = clips.create_clip(lib, io.BytesIO(content), "copy.npz").clip.id
    work(lib.settings)
    for _ in comparison.compare_pending(lib):
        pass
    return original, copy
