"""Clips of an earlier analysis are analyzed again at the start of a worker or on request."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import update

from app.analysis import array_shapes
from app.demo import DemoClip
from app.errors import ClipNotReady, ModelNotFitted
from app.services.clips import catalogue as clips
from app.services.clips import reanalysis
from app.services.find.find import find_motion, find_words
from app.services.find.queries import MotionQuery, WordQuery
from app.services.find.query_source import QuerySource
from app.services.library.fitted_models import FittedModels
from app.services.library.library import Library
from app.services.recognition.recognize import RecognizeQuery, recognize
from app.services.training import models
from app.store.clips import arrays
from app.store.clips import repository as stored
from app.store.clips.record import ClipState, Reanalysis
from app.store.database import tables
from tests.libraries import upload, work
from tests.store.stored_arrays import array_versions


def _make_ready(lib: Library, demo: list[DemoClip]) -> list[str]:
    ids = [upload(lib, clip).clip.id for clip in demo]
    work(lib.settings)
    return ids


def test_a_worker_analyzes_outdated_clips_when_it_starts(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as old:
        old.setattr("app.services.clips.ingest.ANALYSIS_VERSION", 0)
        # An older program's worker knows no other version.
        old.setattr("app.services.clips.reanalysis.ANALYSIS_VERSION", 0)
        first, second = _make_ready(lib, some_demo_clips[:2])
    assert clips.get_clip(lib, first).analysis_version == 0

    work(lib.settings)

    found = clips.get_clip(lib, first)
    assert found.state is ClipState.READY
    assert found.analysis_version == reanalysis.ANALYSIS_VERSION
    hits = find_motion(lib, MotionQuery(QuerySource(first)))
    assert [hit.clip.id for hit in hits.items] == [second]


def test_searches_find_clips_that_wait_for_another_analysis(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    first, second = _make_ready(lib, some_demo_clips[:2])
    assert reanalysis.requeue_ready(lib) == 2
    assert [hit.clip.id for hit in find_motion(lib, MotionQuery(QuerySource(first))).items] == [
        second
    ]


def _remove_file(lib: Library, clip_id: str) -> Path:
    """Move a clip's file away; returns its new path."""
    place = clips.open_file(lib, clip_id).path
    return place.rename(place.with_suffix(".lost"))


def test_a_ready_clip_whose_file_is_missing_keeps_its_analysis_with_a_warning(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    first, second = _make_ready(lib, some_demo_clips[:2])
    before = clips.get_clip(lib, first)
    lost = _remove_file(lib, first)
    clips.update_clip(lib, first, {"frame_rate": 15.0})
    work(lib.settings)
    kept = clips.get_clip(lib, first)
    assert (kept.state, kept.reanalysis) == (ClipState.READY, Reanalysis.FAILED)
    assert (kept.frame_rate, kept.error) == (before.frame_rate, None)
    (warning,) = [w.detail for w in kept.warnings if w.code == "file_missing"]
    assert kept.sha256 in warning
    assert "kinedex reanalyze" in warning
    assert [hit.clip.id for hit in find_motion(lib, MotionQuery(QuerySource(second))).items] == [
        first
    ]

    lost.rename(lost.with_suffix(""))
    work(lib.settings)  # a worker that starts tries again
    healed = clips.get_clip(lib, first)
    assert (healed.reanalysis, healed.frame_rate) == (None, 15.0)
    assert "file_missing" not in {warning.code for warning in healed.warnings}


def test_a_clip_that_never_was_ready_fails_if_its_file_is_missing(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    clip = upload(lib, some_demo_clips[0]).clip
    _remove_file(lib, clip.id)
    work(lib.settings)
    failed = clips.get_clip(lib, clip.id)
    assert failed.state is ClipState.FAILED
    assert failed.error is not None
    assert failed.error["code"] == "file_missing"
    assert "stored motion file" in failed.error["detail"]


METHODS = ("fused", "vector", "dtw", "msv-dtw", "msv-xcorr", "metric-task", "metric-person")


def test_during_an_upgrade_that_changes_shapes_searches_leave_old_clips_out(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    ids = _make_ready(lib, some_demo_clips)
    models.request_fit(lib)
    work(lib.settings)
    old, asked, *_ = ids
    with lib.store.write() as tx:
        wider = {
            name: np.concatenate([array, array], axis=-1)
            for name, array in arrays.get_named(tx, old, array_versions(tx, old)).items()
        }
        arrays.put_many(tx, old, wider, version=0)
        tx.execute(update(tables.clips).where(tables.clips.c.id == old).values(analysis_version=0))
        stored.patch(tx, old, {"source": "touched"})  # indexes read it again
    assert reanalysis.requeue_outdated(lib) == 1

    for scope, methods in (("clips", METHODS), ("windows", METHODS[:3]), ("segments", METHODS[:1])):
        for method in methods:
            hits = find_motion(
                lib, MotionQuery(QuerySource(asked), method=method, scope=scope, limit=1000)
            )
            found = {hit.clip.id for hit in hits.items}
            assert found, (scope, method)
            assert old not in found, (scope, method)
    assert find_words(lib, WordQuery(["walk"], limit=100)).items
    assert recognize(lib, RecognizeQuery(QuerySource(asked))).words
    with pytest.raises(ClipNotReady, match="another version"):
        find_motion(lib, MotionQuery(QuerySource(old)))

    work(lib.settings)
    hits = find_motion(lib, MotionQuery(QuerySource(asked), limit=1000)).items
    assert {hit.clip.id for hit in hits} == set(ids) - {asked}


def test_a_model_fitted_on_arrays_of_other_shapes_is_not_used(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    _make_ready(lib, some_demo_clips)
    models.request_fit(lib)
    work(lib.settings)
    assert lib.models.words(lib.store)
    other = {**array_shapes.SHAPES, "symbol_statistics": (140,)}
    monkeypatch.setattr("app.services.library.fitted_models.SHAPES", other)
    with pytest.raises(ModelNotFitted, match="another version"):
        FittedModels().words(lib.store)


def test_up_to_date_clips_are_not_queued(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    _make_ready(lib, some_demo_clips[:2])
    assert reanalysis.requeue_outdated(lib) == 0


def test_all_ready_clips_can_be_queued(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    (only,) = _make_ready(lib, some_demo_clips[:1])
    assert reanalysis.requeue_ready(lib) == 1
    waiting = clips.get_clip(lib, only)
    assert (waiting.state, waiting.reanalysis) == (ClipState.READY, Reanalysis.QUEUED)
    work(lib.settings)
    done = clips.get_clip(lib, only)
    assert (done.state, done.reanalysis) == (ClipState.READY, None)
