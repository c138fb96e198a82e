"""Pages of hits: the JSON is the same as that of their models, made slowly."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import pytest
from pydantic import BaseModel

from app.api.hit_pages import HitPage
from app.api.schemas.composed_search import ComposedHits
from app.api.schemas.pose import PoseHits
from app.api.schemas.search import MotionHits, WordHits
from app.errors import BadField
from app.search.index.facets import Facet
from app.services.find.hits import Hit, HitGroup, Hits, PartScore
from app.store.clips.partial import FIELDS, PartialClip
from app.store.clips.record import ClipOrigin, ClipState, ClipWarning, Reanalysis

FULL: dict[str, Any] = {
    "id": "clip_1",
    "name": 'Über "alles"\u2028',
    "path": "a/b.bvh",
    "state": ClipState.READY,
    "format": "bvh",
    "sha256": "0" * 64,
    "person": "ada",
    "task": None,
    "words": ("walk", "slow"),
    "captions": ("Somebody walks.",),
    "license": None,
    "source": "bench",
    "metadata": {"age": 30, "is_old": True, "mean": 1e-7, "text": "<a>"},
    "frames": 120,
    "frame_rate": 30.0,
    "declared_frame_rate": 29.97,
    "duration": 4.0,
    "start_offset": -0.5,
    "joints": 22,
    "travel": 1.25,
    "speed": 1 / 3,
    "energy": 1e16,
    "tempo": None,
    "roles": {"hips": "Hips"},
    "missing_roles": ("head",),
    "warnings": (ClipWarning("jump", "A jump.", start=1.0, joint="Hips"), ClipWarning("a", "b")),
    "created_at": datetime(2026, 12, 1, 12, 0, 0, 1500, UTC),
    "has_audio": True,
    "audio_begins_at": 0.1,
    "error": {"code": "unreadable", "detail": "Line 3."},
    "reanalysis": Reanalysis.FAILED,
    "origin": ClipOrigin("clip_0", ({"kind": "cut", "start": 0.5, "end": None},), is_deleted=True),
}
EMPTY = FULL | dict.fromkeys(("path", "duration", "frame_rate", "error", "reanalysis", "origin"))


PARTS = (PartScore("words.0", True, 0.123456, 0.25), PartScore("file", False, 1.0, 0.0))
FACETS = {"task": Facet((("walk", 2),), 1, 3), "speed": Facet(quartiles=(0.0, 1.0, 2.0, 3.0, 4.0))}


def _hits(
    parts: tuple[PartScore, ...] = (), time: float | None = None, group: HitGroup | None = None
) -> Hits:
    hits = [
        Hit(
            rank,
            1 / (3 + rank),
            0.1 * rank,
            0.1 + 0.2,
            1 / 3,
            PartialClip(values),
            time,
            parts,
            group,
        )
        for rank, values in enumerate((FULL, EMPTY | {"created_at": FULL["created_at"]}), 1)
    ]
    return Hits(
        "fused", 1.5, 7, tuple(hits), "cursor", ("zz",), {"jog": ("run",)}, {"jog": 0.123456}
    )


PAGES = [
    (MotionHits, _hits()),
    (MotionHits, replace(_hits(), items=(), next=None, expanded=None, confidence=None)),
    (WordHits, _hits()),
    (WordHits, replace(_hits(), expanded=None, confidence=None)),
    (PoseHits, _hits(time=0.25)),
    (ComposedHits, _hits(PARTS)),
    (ComposedHits, replace(_hits(PARTS, group=HitGroup("person", None, 1)), facets=FACETS)),
]


@pytest.mark.parametrize(("page", "hits"), PAGES)
def test_a_page_is_written_as_its_model_writes_it(page: type[BaseModel], hits: Hits) -> None:
    slow = page.model_validate(hits).model_dump_json()
    assert bytes(HitPage.of(page, None).answer(hits).body).decode() == slow


@pytest.mark.parametrize(("page", "hits"), PAGES)
def test_chosen_fields_are_those_of_the_whole_page(page: type[BaseModel], hits: Hits) -> None:
    whole = page.model_validate(hits).model_dump(mode="json")
    chosen = HitPage.of(page, ["score", "clip.name", "clip.audio_offset"])
    assert chosen.clip_fields == {"name", "audio_begins_at"}
    expected = [
        {
            "score": hit["score"],
            "clip": {name: hit["clip"][name] for name in ("name", "audio_offset")},
        }
        for hit in whole["items"]
    ]
    assert json.loads(chosen.answer(hits).body) == whole | {"items": expected[: len(hits.items)]}


def test_a_page_without_clips_needs_no_field_of_them() -> None:
    page = HitPage.of(MotionHits, ["rank"])
    assert page.clip_fields == frozenset()
    items = json.loads(page.answer(_hits()).body)["items"]
    assert items == [{"rank": 1}, {"rank": 2}]


def test_all_fields_of_a_clip_can_be_read_from_the_store() -> None:
    assert HitPage.of(MotionHits, None).clip_fields <= FIELDS


@pytest.mark.parametrize("name", ["nam", "clip.nam", "score.x", "clip.", ""])
def test_an_unknown_field_is_refused(name: str) -> None:
    with pytest.raises(BadField):
        HitPage.of(MotionHits, ["rank", name])
