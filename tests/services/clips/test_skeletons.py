"""AMC with its ASF, and C3D, from upload to search."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from app.errors import BadField, MotionNeeded, SkeletonNeeded, SkeletonNotNeeded, Unreadable
from app.kinedex_error import KinedexError
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.clips.catalogue import Created
from app.services.find import find
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.imports import imports
from app.services.library.library import Library
from app.services.recognition import recognize
from app.services.recognition.recognize import RecognizeQuery
from app.store.clips.record import ClipRecord, ClipState
from tests.formats.acclaim.files import acclaim_person
from tests.formats.c3d.files import c3d, marker_person, stacked
from tests.formats.samples import bvh
from tests.libraries import settings_for, work

ASF, AMC, _ = acclaim_person(frames=80, seed=1)
_, OTHER_AMC, _ = acclaim_person(frames=80, seed=2)


def create(
    lib: Library, content: bytes, skeleton: bytes | None, name: str = "07_01.amc"
) -> Created:
    companion = None if skeleton is None else io.BytesIO(skeleton)
    return clips.create_clip(lib, io.BytesIO(content), name, skeleton=companion)


def by_name(lib: Library) -> dict[str, ClipRecord]:
    return {clip.name: clip for clip in clips.list_clips(lib, limit=100).items}


@pytest.fixture(scope="module")
def paired(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """A library of two AMC clips with one skeleton, one without any, and a C3D clip."""
    lib = Library.open(settings_for(tmp_path_factory.mktemp("paired")))
    create(lib, AMC, ASF)
    create(lib, OTHER_AMC, ASF, "07_02.amc")
    create(lib, OTHER_AMC, None, "lonely.amc")
    create(lib, ASF, None, "07.asf")
    create(lib, c3d(*stacked(marker_person(frames=80, seed=3)[0])), None, "trial.c3d")
    work(lib.settings)
    yield lib
    lib.close()


def test_an_amc_with_its_asf_becomes_a_clip_with_warnings_for_assumptions(paired: Library) -> None:
    clip = by_name(paired)["07_01"]
    assert (clip.state, clip.format, clip.frames) == (ClipState.READY, "amc", 80)
    assert (clip.frame_rate, clip.declared_frame_rate) == (120, None)
    assert clip.metres_per_unit == pytest.approx(0.056444, abs=1e-6)
    assert clip.missing_roles == ()
    assert "frame_rate_assumed" in [warning.code for warning in clip.warnings]


def test_a_c3d_file_becomes_a_clip(paired: Library) -> None:
    clip = by_name(paired)["trial"]
    assert (clip.state, clip.format, clip.frames) == (ClipState.READY, "c3d", 80)
    assert (clip.frame_rate, clip.metres_per_unit, clip.missing_roles) == (100, 0.001, ())


def test_an_amc_or_an_asf_alone_fails_with_a_clear_reason(paired: Library) -> None:
    for name, code in (("lonely", "skeleton_needed"), ("07", "motion_needed")):
        clip = by_name(paired)[name]
        assert clip.state is ClipState.FAILED
        assert clip.error is not None
        assert clip.error["code"] == code


def test_the_same_pair_again_is_the_same_clip(paired: Library) -> None:
    again = create(paired, AMC, ASF, "other.amc")
    assert not again.is_new
    assert again.clip.id == by_name(paired)["07_01"].id


def test_a_search_by_an_uploaded_pair_finds_the_stored_one(paired: Library) -> None:
    source = QuerySource(content=io.BytesIO(AMC), skeleton=io.BytesIO(ASF))
    query = MotionQuery(source, include_self=True)
    best = find.find_motion(paired, query).items[0]
    assert best.clip.name == "07_01"
    assert best.distance == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize(
    ("content", "skeleton", "failure"),
    [
        (AMC, None, SkeletonNeeded),
        (ASF, AMC, MotionNeeded),
        (bvh(), ASF, SkeletonNotNeeded),
        (AMC, ASF[:900], Unreadable),
    ],
)
def test_an_upload_that_is_no_pair_is_refused_by_searches(
    paired: Library, content: bytes, skeleton: bytes | None, failure: type[Exception]
) -> None:
    def sent() -> QuerySource:
        companion = None if skeleton is None else io.BytesIO(skeleton)
        return QuerySource(content=io.BytesIO(content), skeleton=companion)

    with pytest.raises(failure):
        find.find_motion(paired, MotionQuery(sent()))
    with pytest.raises(KinedexError):
        recognize.recognize(paired, RecognizeQuery(sent()))


@pytest.mark.parametrize(
    ("content", "skeleton"), [(bvh(), ASF), (AMC, bvh()), (AMC, b""), (AMC, b"hello"), (ASF, AMC)]
)
def test_a_wrong_skeleton_is_refused_and_nothing_is_stored(
    lib: Library, content: bytes, skeleton: bytes
) -> None:
    with pytest.raises(BadField) as caught:
        create(lib, content, skeleton)
    assert caught.value.places[0].location == "skeleton"
    assert list(lib.store.files) == []
    assert by_name(lib) == {}


def test_a_skeleton_stays_while_a_clip_needs_it(lib: Library) -> None:
    first = create(lib, AMC, ASF).clip
    second = create(lib, OTHER_AMC, ASF).clip
    assert len(list(lib.store.files)) == 3
    clips.delete_clip(lib, first.id)
    assert len(list(lib.store.files)) == 2
    clips.delete_clip(lib, second.id)
    assert list(lib.store.files) == []


FOLDER = {
    "subjects/07/07.asf": ASF,
    "subjects/07/07_01.amc": AMC,
    "subjects/07/07_02.amc": OTHER_AMC,
    "manifest.csv": b"path,person,fps\nsubjects/07/07_01.amc,ann,60\nsubjects/07/07.asf,ann,\n",
}


def check_imported(lib: Library, result: dict[str, Any] | None) -> None:
    assert result is not None
    outcomes = {line["path"]: line["outcome"] for line in result["files"]}
    assert outcomes == {path: "ready" for path in FOLDER if path.endswith(".amc")}
    found = by_name(lib)
    assert found.keys() == {"07_01", "07_02"}
    assert (found["07_01"].person, found["07_01"].frame_rate) == ("ann", 60)
    assert found["07_02"].frame_rate == 120


def test_a_zip_with_pairs_is_imported(lib: Library) -> None:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as opened:
        for path, content in FOLDER.items():
            opened.writestr(path, content)
    archive.seek(0)
    job = imports.start_import(lib, archive, "set.zip")
    work(lib.settings)
    check_imported(lib, jobs.get_job(lib, job.id).result)


def test_a_folder_with_pairs_and_a_single_amc_file_are_imported(
    lib: Library, tmp_path: Path
) -> None:
    for path, content in FOLDER.items():
        (tmp_path / "in" / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "in" / path).write_bytes(content)
    job = imports.import_path(lib, tmp_path / "in")
    work(lib.settings)
    check_imported(lib, jobs.get_job(lib, job.id).result)
    single = imports.import_path(lib, tmp_path / "in" / "subjects" / "07" / "07_01.amc")
    result = jobs.get_job(lib, single.id).result
    assert result is not None
    assert [(line["path"], line["outcome"]) for line in result["files"]] == [
        ("07_01.amc", "unchanged")
    ]


def test_an_amc_without_its_skeleton_fails_with_a_reason(lib: Library, tmp_path: Path) -> None:
    (tmp_path / "07_01.amc").write_bytes(AMC)
    job = imports.import_path(lib, tmp_path / "07_01.amc")
    work(lib.settings)
    result = jobs.get_job(lib, job.id).result
    assert result is not None
    (line,) = result["files"]
    assert line["outcome"] == "failed"
    assert "skeleton" in str(line)
