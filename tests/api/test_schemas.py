"""Answers are built from values of other layers, and show only the fields of their schema."""

from __future__ import annotations

import dataclasses
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

from app.api.schemas.clips import Clip, ClipCreated, ClipForm, ClipList, ClipPatch
from app.api.schemas.jobs import Job
from app.services import clip_fields
from app.services.clips.catalogue import PATCHABLE, Created
from app.services.imports.manifest import COLUMNS
from app.store.clips.record import (
    AnalysisHints,
    AttachedAudio,
    ClipLabels,
    ClipRecord,
    ClipState,
    ClipWarning,
)
from app.store.database.paging import Page
from app.store.database.totals import Total
from app.store.jobs.record import JobKind, JobRecord, JobState
from tests.api.test_clips import CLIP_FIELDS

NOW = datetime(2026, 1, 2, tzinfo=UTC)
CLIP = ClipRecord(
    name="walk",
    person="anna",
    task="walk",
    words=("walk", "slow"),
    license="CC0",
    source="lab",
    metadata={"condition": "tired", "age": 30},
    id="clip_1",
    path="lab/anna/walk.bvh",
    imported={"person": "secret"},
    state=ClipState.READY,
    format="bvh",
    sha256="a" * 64,
    frames=90,
    frame_rate=30.0,
    declared_frame_rate=None,
    duration=3.0,
    joints=22,
    travel=4.5,
    speed=1.5,
    energy=0.8,
    tempo=None,
    roles={"hips": "Hips"},
    missing_roles=("head",),
    warnings=(
        ClipWarning("frame_rate_suspect", "looks like 60", 60.0),
        ClipWarning("bone_length_jumps", "a jump", None, 0.5, 0.75, "LeftHand"),
    ),
    created_at=NOW,
    error={"code": "unreadable", "detail": "Bad."},
    metres_per_unit=0.01,
    content_key="secret",
    file_name="secret.bvh",
    file_size=7,
    skeleton_sha256="secret",
    hints=AnalysisHints(frame_rate=60.0, audio_offset=-1.5),
    audio=AttachedAudio("b" * 64, "secret.wav", 7),
    audio_offset=0.5,
    start_offset=0.0,
    analysis_version=3,
    reanalysis=None,
    is_changed=True,
    origin=None,
    changed_version=4,
)
JOB = JobRecord(
    "job_1",
    JobKind.INGEST,
    JobState.QUEUED,
    "clip_1",
    0.0,
    None,
    NOW,
    None,
    None,
    {"files": []},
    None,
)


def test_a_clip_shows_only_the_fields_of_its_schema() -> None:
    shown = Clip.model_validate(CLIP).model_dump(mode="json")
    assert set(shown) == CLIP_FIELDS
    assert "secret" not in str(shown)
    assert (shown["words"], shown["missing_roles"]) == (["walk", "slow"], ["head"])
    nowhere = {"start": None, "end": None, "joint": None}
    assert shown["warnings"] == [
        {"code": "frame_rate_suspect", "detail": "looks like 60", "likely": 60.0, **nowhere},
        {
            "code": "bone_length_jumps",
            "detail": "a jump",
            "likely": None,
            "start": 0.5,
            "end": 0.75,
            "joint": "LeftHand",
        },
    ]
    assert (shown["frame_rate"], shown["has_audio"], shown["audio_offset"]) == (30.0, True, -1.5)
    assert (shown["error"]["code"], shown["error"]["detail"]) == ("unreadable", "Bad.")


def test_an_estimated_offset_is_shown_if_none_was_given() -> None:
    estimated = dataclasses.replace(CLIP, hints=AnalysisHints())
    assert Clip.model_validate(estimated).audio_offset == 0.5
    silent = Clip.model_validate(dataclasses.replace(CLIP, audio=None))
    assert (silent.has_audio, silent.audio_offset) == (False, None)


def test_an_attribute_that_is_not_in_the_schema_is_not_shown() -> None:
    named: dict[str, Any] = {
        field.name: getattr(JOB, field.name) for field in dataclasses.fields(JOB)
    }
    shown = Job.model_validate(SimpleNamespace(**named, owner="secret")).model_dump()
    assert set(shown) == Job.model_fields.keys()


def test_answers_with_other_answers_inside_are_built_at_once() -> None:
    created = ClipCreated.model_validate(Created(CLIP, JOB, is_new=True))
    assert created.clip == Clip.model_validate(CLIP)
    assert created.job == Job.model_validate(JOB)
    assert set(created.model_dump()) == {"clip", "job", "differences"}
    page = ClipList.model_validate(Page((CLIP,), "more").counted(Total(7)))
    assert (page.items, page.next, page.total) == ([created.clip], "more", 7)


def test_every_label_and_hint_has_its_check_its_form_field_and_its_column() -> None:
    labels = {field.name for field in dataclasses.fields(ClipLabels)}
    hints = {field.name for field in dataclasses.fields(AnalysisHints)}
    assert clip_fields.LABELS.keys() == labels
    assert {"metres_per_unit" if one == "unit" else one for one in clip_fields.HINTS} == hints
    of_a_clip = ClipForm.model_fields.keys() - {"path", "on_conflict"}
    assert of_a_clip == clip_fields.LABELS.keys() | clip_fields.HINTS.keys()
    assert ClipPatch.model_fields.keys() == set(PATCHABLE)
    assert labels < Clip.model_fields.keys()
    not_in_manifests = {"roles", "stack", "metadata"}
    assert {*COLUMNS} == (of_a_clip - not_in_manifests) | {"fps", "keyposes"}
