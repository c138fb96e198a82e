"""A body becomes a QuerySource with all fields that the client sent."""

from __future__ import annotations

import io
from dataclasses import fields, replace

import pytest

from app.api.schemas.pose import PoseSearch
from app.api.schemas.query_source import QueryForm
from app.api.schemas.recognition import Recognize, RecognizeForm
from app.api.schemas.search import MotionSearch, MotionSearchForm
from app.services.find.query_source import UPLOAD_ONLY, QuerySource

SENT = {
    "unit": "cm",
    "frame_rate": "30",
    "up_axis": "-y",
    "roles": '{"hips": "Pelvis"}',
    "stack": "run",
    "start": "0.5",
    "end": "1.5",
}
HINTS = QuerySource(unit="cm", frame_rate=30.0, up_axis="-y", roles={"hips": "Pelvis"}, stack="run")


def test_a_form_fills_every_field_of_a_source() -> None:
    content, skeleton = io.BytesIO(b"motion"), io.BytesIO(b"skeleton")
    source = MotionSearchForm.model_validate(SENT).source(content, skeleton)
    assert source == replace(HINTS, content=content, skeleton=skeleton, start=0.5, end=1.5)
    empty = {f.name for f in fields(QuerySource) if getattr(source, f.name) is None}
    assert empty == {"clip_id"}


def test_all_forms_take_the_hints_about_an_upload() -> None:
    assert set(UPLOAD_ONLY) - {"skeleton"} <= QueryForm.model_fields.keys()
    sent = {name: value for name, value in SENT.items() if name not in ("start", "end")}
    assert RecognizeForm.model_validate(sent).source() == HINTS


@pytest.mark.parametrize("model", [MotionSearch, Recognize, PoseSearch, MotionSearchForm])
def test_a_stored_clip_is_a_source_by_its_id(model: type[MotionSearch]) -> None:
    assert model.model_validate({"clip_id": "clip_1"}).source() == QuerySource("clip_1")


def test_a_part_of_a_stored_clip_is_a_source() -> None:
    sent = MotionSearch.model_validate({"clip_id": "clip_1", "start": 1, "segment": 2})
    query = sent.query(sent.source(), sent.segment)
    assert (query.source, query.segment) == (QuerySource("clip_1", start=1.0), 2)


def test_a_search_by_13_positions_has_no_source() -> None:
    assert PoseSearch.model_validate({"positions": []}).query().source is None
    found = PoseSearch.model_validate({"clip_id": "clip_1", "time": 1}).query()
    assert found.source == QuerySource("clip_1")
