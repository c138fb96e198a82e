"""Clips of an earlier analysis are analysed again, by the worker that starts or when asked."""

from __future__ import annotations

import pytest

from app.services import clips, reanalysis
from app.services.demo import DemoClip
from app.services.find import MotionQuery, find_motion
from app.services.library import Library
from app.store.clip_record import ClipState
from tests.services.conftest import upload, work


def _make_ready(lib: Library, demo: list[DemoClip]) -> list[str]:
    ids = [upload(lib, clip).clip.id for clip in demo]
    work(lib.settings)
    return ids


def test_a_worker_that_starts_brings_old_clips_up_to_date(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as old:
        old.setattr("app.services.ingest.ANALYSIS_VERSION", 0)
        # An older program's worker knows no other version.
        old.setattr("app.services.reanalysis.ANALYSIS_VERSION", 0)
        first, second = _make_ready(lib, some_demo_clips[:2])
    assert clips.get_clip(lib, first).analysis_version == 0

    work(lib.settings)

    found = clips.get_clip(lib, first)
    assert found.state is ClipState.READY
    assert found.analysis_version == reanalysis.ANALYSIS_VERSION
    hits = find_motion(lib, MotionQuery(clip_id=first))
    assert [hit.clip.id for hit in hits.items] == [second]


def test_what_is_up_to_date_is_left_alone(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    _make_ready(lib, some_demo_clips[:2])
    assert reanalysis.requeue_outdated(lib) == 0


def test_all_ready_clips_when_asked(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    (only,) = _make_ready(lib, some_demo_clips[:1])
    assert reanalysis.requeue_in_state(lib, ClipState.READY) == 1
    assert clips.get_clip(lib, only).state is ClipState.QUEUED
    work(lib.settings)
    assert clips.get_clip(lib, only).state is ClipState.READY
