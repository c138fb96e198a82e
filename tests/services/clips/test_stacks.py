"""The animation stack of an FBX file: chosen at upload, later, and for a query."""

from __future__ import annotations

import io
from collections.abc import Iterator

import pytest

from app.errors import BadField
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.recognition import recognize
from app.services.recognition.recognize import RecognizeQuery
from app.services.views import export
from app.store.clips.record import ClipRecord, ClipState, Reanalysis
from tests.formats.fbx.takes import person_takes
from tests.formats.samples import bvh
from tests.libraries import settings_for, work

TAKES = person_takes({"bow": 1.0, "sway": 2.0})


@pytest.fixture(scope="module")
def lib(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path_factory.mktemp("stacks")))
    yield opened
    opened.close()


def upload(lib: Library, stack: str | None, extra: bytes = b"") -> ClipRecord:
    """The FBX file; `extra` bytes at its end, which readers ignore, make it a different clip."""
    said = {"stack": stack}
    return clips.create_clip(lib, io.BytesIO(TAKES + extra), "takes.fbx", said).clip


def worked(lib: Library, clip_id: str) -> ClipRecord:
    work(lib.settings)
    return clips.get_clip(lib, clip_id)


def test_the_longest_stack_is_read_and_a_warning_names_the_others(lib: Library) -> None:
    clip = worked(lib, upload(lib, None).id)
    assert (clip.state, clip.frames) == (ClipState.READY, 61)
    (warning,) = [w.detail for w in clip.warnings if w.code == "stack_chosen"]
    assert "(bow, sway); sway was read" in warning


def test_another_stack_can_be_chosen_later_and_null_resets_it(lib: Library) -> None:
    clip = worked(lib, upload(lib, "bow", b"1").id)
    assert (clip.state, clip.frames) == (ClipState.READY, 31)
    assert clips.update_clip(lib, clip.id, {"stack": " bow "}).state is ClipState.READY
    queued = clips.update_clip(lib, clip.id, {"stack": None})
    assert (queued.reanalysis, queued.hints.stack) == (Reanalysis.QUEUED, None)
    assert worked(lib, clip.id).frames == 61
    clips.update_clip(lib, clip.id, {"stack": "bow"})
    assert worked(lib, clip.id).frames == 31
    file = export.export(lib, clip.id, "bvh")
    assert b"Frames: 31" in b"".join(file.blocks)


def test_an_unknown_stack_fails_with_a_list_and_can_be_corrected(lib: Library) -> None:
    failed = worked(lib, upload(lib, "run", b"2").id)
    assert failed.state is ClipState.FAILED
    assert failed.error is not None
    (place,) = failed.error["errors"]
    assert place["location"] == "stack"
    assert "(bow, sway), found 'run'" in place["message"]
    clips.update_clip(lib, failed.id, {"stack": "bow"})
    assert worked(lib, failed.id).frames == 31


def test_other_formats_have_no_stacks(lib: Library) -> None:
    content = bvh()
    with pytest.raises(BadField, match="not with BVH"):
        clips.create_clip(lib, io.BytesIO(content), "a.bvh", {"stack": "bow"})
    clip = clips.create_clip(lib, io.BytesIO(content), "a.bvh", {"stack": " "}).clip
    with pytest.raises(BadField, match="not with BVH"):
        clips.update_clip(lib, clip.id, {"stack": "bow"})
    assert clips.update_clip(lib, clip.id, {"stack": None}).state is ClipState.QUEUED


def test_a_query_is_read_from_its_stack(lib: Library) -> None:
    clip = worked(lib, upload(lib, "bow", b"3").id)

    def distance(stack: str | None) -> float:
        query = MotionQuery(QuerySource(content=io.BytesIO(TAKES), stack=stack), limit=100)
        hits = find.find_motion(lib, query).items
        return next(hit.distance for hit in hits if hit.clip.id == clip.id)

    assert distance("bow") == pytest.approx(0, abs=1e-4)
    assert distance(None) > 0.01
    with pytest.raises(BadField, match="bow, sway"):
        find.find_motion(lib, MotionQuery(QuerySource(content=io.BytesIO(TAKES), stack="run")))
    with pytest.raises(BadField, match="bow, sway"):
        recognize.recognize(
            lib, RecognizeQuery(QuerySource(content=io.BytesIO(TAKES), stack="run"))
        )
    with pytest.raises(BadField, match="uploaded file"):
        find.find_motion(lib, MotionQuery(QuerySource(clip.id, stack="bow")))
