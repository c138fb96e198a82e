"""Importing again with other labels: what is applied, what conflicts, and what is reported."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.demo import DemoClip
from app.errors import BadField
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.clips.manifest_export import manifest
from app.services.imports import imports
from app.services.imports.options import ImportOptions
from app.services.library.library import Library
from app.services.views import keyposes
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.jobs.record import JobRecord
from tests.libraries import work

A, B = "set/a.bvh", "set/b.bvh"


@pytest.fixture
def folder(tmp_path: Path, some_demo_clips: list[DemoClip]) -> Path:
    """Two clips in a folder of an import."""
    (tmp_path / "in" / "set").mkdir(parents=True)
    for path, clip in zip((A, B), some_demo_clips, strict=False):
        (tmp_path / "in" / path).write_bytes(clip.content)
    return tmp_path / "in"


def _import(lib: Library, folder: Path, table: str = "", **options: Any) -> dict[str, Any]:
    """Import with this manifest; returns the outcomes and differences by path."""
    (folder / "manifest.csv").write_text(table)
    if not table:
        (folder / "manifest.csv").unlink()
    job = imports.import_path(lib, folder, options=ImportOptions(**options))
    return {
        file.path: (file.outcome.value, {d["field"]: d["applied"] for d in file.differences})
        for file in jobs.all_files(lib, job.id)
    }


def _clip(lib: Library, path: str) -> ClipRecord:
    found = {clip.path: clip for clip in clips.list_clips(lib).items}
    return found[path]


def test_a_corrected_manifest_is_applied_and_an_edit_since_conflicts(
    lib: Library, folder: Path
) -> None:
    head = "path,person,task,words,age\n"
    first = _import(lib, folder, f"{head}{A},ann,wlak,slow,30\n{B},bob,run,,\n")
    assert first == {A: ("queued", {}), B: ("queued", {})}
    work(lib.settings)
    same = _import(lib, folder, f"{head}{A},ann,wlak,slow,30\n{B},bob,run,,\n")
    assert same == {A: ("unchanged", {}), B: ("unchanged", {})}

    clips.update_clip(lib, _clip(lib, B).id, {"task": "jog", "metadata": {"age": 41}})
    kept = _import(lib, folder, f"{head}{A},ann,wlak,slow,30\n{B},bob,run,,\n")
    assert kept == same
    assert _clip(lib, B).task == "jog"

    table = f"{head}{A},,walk,slow calm,31\n{B},bob,sprint,fast,41\n"
    again = _import(lib, folder, table)
    applied = {"person": True, "task": True, "words": True, "meta.age": True}
    assert again == {A: ("updated", applied), B: ("conflicting", {"task": False, "words": True})}
    a, b = _clip(lib, A), _clip(lib, B)
    assert (a.person, a.task, a.words, a.metadata) == (None, "walk", ("slow", "calm"), {"age": 31})
    assert (b.task, b.words, b.metadata) == ("jog", ("fast",), {"age": 41})

    assert _import(lib, folder, table)[B] == ("conflicting", {"task": False})
    assert _import(lib, folder, table, overwrite=True)[B] == ("updated", {"task": True})
    assert _clip(lib, B).task == "sprint"
    assert _import(lib, folder, table) == {A: ("unchanged", {}), B: ("unchanged", {})}


def test_a_corrected_hint_is_applied_and_the_clip_analyzed_again(
    lib: Library, folder: Path
) -> None:
    _import(lib, folder, f"path,fps,keyposes\n{A},60,0.1 0.3\n")
    work(lib.settings)
    before = _clip(lib, A)
    found = _import(lib, folder, f"path,fps,keyposes\n{A},30,0.2\n")
    assert found[A] == ("updated", {"frame_rate": True, "keyposes": True})
    work(lib.settings)
    after = _clip(lib, A)
    assert (before.frame_rate, after.frame_rate, after.reanalysis) == (60.0, 30.0, None)
    assert keyposes.view(lib, after.id).named == (0.2,)
    keyposes.annotate_keyposes(lib, after.id, [0.4])
    found = _import(lib, folder, f"path,fps,keyposes\n{A},30,0.5\n")
    assert found[A] == ("conflicting", {"keyposes": False})


def test_two_files_with_one_content_do_not_change_the_labels_in_turn(
    lib: Library, folder: Path
) -> None:
    (folder / "set" / "twin.bvh").write_bytes((folder / A).read_bytes())
    table = f"path,task\n{A},walk\nset/twin.bvh,run\n"
    twin = ("conflicting", {"task": False})
    assert _import(lib, folder, table)["set/twin.bvh"] == twin
    work(lib.settings)
    again = _import(lib, folder, table, overwrite=True)
    assert (again[A], again["set/twin.bvh"]) == (("unchanged", {}), twin)
    assert _clip(lib, A).task == "walk"


def test_a_moved_file_gets_its_new_path_and_keeps_its_edits(lib: Library, folder: Path) -> None:
    _import(lib, folder)
    work(lib.settings)
    clips.update_clip(lib, _clip(lib, A).id, {"person": "ann"})
    (folder / "set").rename(folder / "new set")
    found = _import(lib, folder)
    assert found["new set/a.bvh"] == ("updated", {"path": True})
    assert _clip(lib, "new set/a.bvh").person == "ann"
    inner = imports.import_path(lib, folder / "new set")
    assert {file.outcome.value for file in jobs.all_files(lib, inner.id)} == {"unchanged"}
    assert _clip(lib, "new set/a.bvh").folder == "new set"


def test_a_row_counts_more_than_the_pattern_and_the_pattern_more_than_the_options(
    lib: Library, folder: Path
) -> None:
    values = {"person": "all", "task": "all", "license": "CC0", "metadata": {"site": 1, "x": 2}}
    table = f"path,person,site\n{A},ann,\n{B},,9\n"
    _import(lib, folder, table, values=values, pattern="{task}/{take}")
    a, b = _clip(lib, A), _clip(lib, B)
    assert (a.person, a.task, a.license) == ("ann", "set", "CC0")
    assert (b.person, b.task, b.license) == ("all", "set", "CC0")
    assert (a.metadata, b.metadata) == (
        {"site": 1, "take": "a", "x": 2},
        {"site": 9, "take": "b", "x": 2},
    )


def test_a_pattern_that_matches_nothing_is_refused_and_some_misses_are_counted(
    lib: Library, folder: Path
) -> None:
    with pytest.raises(BadField, match="matches no file"):
        _import(lib, folder, pattern="{person}/x/{task}.bvh")
    (folder / "top.bvh").write_bytes(b"HIERARCHY\n")
    job = imports.import_path(lib, folder, options=ImportOptions(pattern="{person}/*"))
    work(lib.settings)
    assert _result(lib, job)["unmatched"] == 1
    with pytest.raises(BadField):
        imports.import_path(lib, folder, options=ImportOptions({"person": "x" * 301}))


def test_what_is_no_motion_is_skipped(lib: Library, folder: Path) -> None:
    for name in ("notes.txt", "empty.md", "photo.png", "07.asf", "inner.zip", "bad.bvh"):
        (folder / name).write_bytes(CONTENTS[name])
    job = imports.import_path(lib, folder)
    outcomes = {file.path: file.outcome.value for file in jobs.all_files(lib, job.id)}
    skipped = dict.fromkeys(
        ("notes.txt", "empty.md", "photo.png", "07.asf", "inner.zip"), "skipped"
    )
    assert outcomes == {A: "queued", B: "queued", "bad.bvh": "failed", **skipped}


CONTENTS = {
    "notes.txt": b"buy milk",
    "empty.md": b"",
    "photo.png": b"\x89PNG\r\n\x1a\n" + bytes(100),
    "07.asf": b":version 1.10\n:name x\n",
    "inner.zip": b"PK\x05\x06" + bytes(18),
    "bad.bvh": b"no motion",
}


def _result(lib: Library, job: JobRecord) -> dict[str, Any]:
    result = jobs.get_job(lib, job.id).result
    assert result is not None
    return result


TEXT = st.text(
    st.characters(exclude_categories=("Cc", "Cs", "Zs", "Zl", "Zp")), min_size=1, max_size=8
)
KEYS = st.text(alphabet="abcXYZ é(),;\"'-_", min_size=1, max_size=6).filter(str.strip)
METADATA = st.dictionaries(
    KEYS,
    st.one_of(st.booleans(), st.integers(-99, 99), st.floats(-1e9, 1e9), TEXT, st.just("007")),
    max_size=3,
)
LABELS = st.fixed_dictionaries(
    {},
    optional={
        "name": TEXT,
        "person": TEXT,
        "task": TEXT,
        "license": TEXT,
        "source": TEXT,
        "words": st.lists(st.sampled_from(("slow", "left_leg", "a")), max_size=2),
        "metadata": METADATA,
        "tempo": st.floats(20, 400),
        "frame_rate": st.floats(20, 200),
        "unit": st.sampled_from(("cm", "m")),
        "beats": st.lists(st.floats(0, 9), max_size=2),
    },
)


@settings(
    max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.tuples(LABELS, LABELS))
def test_an_exported_manifest_gives_an_empty_library_the_same_labels(
    lib: Library, folder: Path, said: tuple[dict[str, Any], dict[str, Any]]
) -> None:
    for path, values in zip((A, B), said, strict=True):
        content = io.BytesIO((folder / path).read_bytes())
        clips.create_clip(lib, content, path, values, path=path)
    before = [_labels(_clip(lib, path)) for path in (A, B)]
    table = b"".join(manifest(lib)).decode()
    assert list(_import(lib, folder, table).values()) == [("queued", {})] * 2
    for path in (A, B):
        clips.delete_clip(lib, _clip(lib, path).id)
    _import(lib, folder, table)
    assert [_labels(_clip(lib, path)) for path in (A, B)] == before
    assert b"".join(manifest(lib, ClipFilter(folder=("set",)))).decode() == table
    for path in (A, B):
        clips.delete_clip(lib, _clip(lib, path).id)


def test_labels_like_formulas_are_no_formulas_in_a_manifest_and_are_read_again(
    lib: Library, folder: Path
) -> None:
    said = {
        "name": "=HYPERLINK(A1)",
        "person": "'=x",
        "task": "-5",
        "source": "+a",
        "words": ["@b"],
        "metadata": {"text": "=1+1", "dash": "-5", "number": -5, "quoted": "''-"},
    }
    clips.create_clip(lib, io.BytesIO((folder / A).read_bytes()), A, said, path=A)
    before = _labels(_clip(lib, A))
    table = b"".join(manifest(lib)).decode()
    cells = [cell for row in csv.reader(io.StringIO(table)) for cell in row]
    assert [cell for cell in cells if cell.startswith(("=", "+", "-", "@"))] == ["-5"]  # the number
    clips.delete_clip(lib, _clip(lib, A).id)
    (folder / B).unlink()
    _import(lib, folder, table)
    assert _labels(_clip(lib, A)) == before


def _labels(clip: ClipRecord) -> tuple[Any, ...]:
    names = ("name", "person", "task", "words", "license", "source", "metadata", "hints", "path")
    kinds = {key: type(value) for key, value in clip.metadata.items()}
    return *(getattr(clip, name) for name in names), kinds
