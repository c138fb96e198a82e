"""From a QuerySource to its analysis request and its descriptors."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from app.errors import BadField, EmptyFile, TooLarge
from app.search.windows import proposals
from app.services.find.query import QueryDescriptors, analysis_request, describe
from app.services.find.query_source import QuerySource
from app.services.library.analysis_pool import AnalysisRequest
from app.services.library.library import Library
from app.store.clips.record import ClipRecord


def test_the_analysis_request_has_all_hints_of_an_upload() -> None:
    source = QuerySource(
        content=io.BytesIO(b"motion"),
        skeleton=io.BytesIO(b"skeleton"),
        frame_rate="30",
        unit="cm",
        roles={"hips": "Pelvis"},
        stack=" run ",
    )
    assert analysis_request(source, max_bytes=8) == AnalysisRequest(
        content=b"motion",
        skeleton=b"skeleton",
        frame_rate=30.0,
        metres_per_unit=0.01,
        roles={"hips": "Pelvis"},
        stack="run",
        for_search=True,
    )


def test_each_file_of_an_upload_has_a_limit_and_is_not_empty() -> None:
    for content, skeleton in ((b"123456789", b"1"), (b"1", b"123456789")):
        source = QuerySource(content=io.BytesIO(content), skeleton=io.BytesIO(skeleton))
        with pytest.raises(TooLarge):
            analysis_request(source, max_bytes=8)
    with pytest.raises(EmptyFile):
        analysis_request(QuerySource(content=io.BytesIO(b"1"), skeleton=io.BytesIO()), max_bytes=8)


@pytest.mark.parametrize("source", [QuerySource(), QuerySource("clip", io.BytesIO(b"x"))])
def test_a_query_is_a_clip_or_a_file(ready_library: Library, source: QuerySource) -> None:
    with pytest.raises(BadField, match="either a clip_id or a file"):
        describe(ready_library, source, ("features_10hz",))


def test_a_part_of_a_stored_clip_has_its_interval(ready_clips: list[ClipRecord]) -> None:
    clip = ready_clips[0]
    duration = clip.duration or 0.0

    def descriptors(**part: float) -> QueryDescriptors:
        return QueryDescriptors(QuerySource(clip.id, **part), {}, clip)

    assert descriptors().seconds == duration
    assert descriptors(start=0.5).seconds == duration - 0.5
    assert descriptors(start=0.5, end=0.75).seconds == 0.25
    interval = descriptors(start=0.5, end=0.75).interval
    assert interval == proposals.ExcludedInterval(clip.id, 0.5, 0.75)


def test_an_upload_has_the_duration_of_its_positions_and_no_interval() -> None:
    arrays = {"role_positions": np.zeros((60, 13, 3))}
    query = QueryDescriptors(QuerySource(content=io.BytesIO(b"x"), start=1.0), arrays, None)
    assert (query.seconds, query.interval) == (2.0, None)


def test_the_queried_clip_is_excluded_unless_it_may_be_a_hit(
    ready_clips: list[ClipRecord],
) -> None:
    clip = ready_clips[0]
    upload = QuerySource(content=io.BytesIO(b"x"))
    for query in (
        QueryDescriptors(QuerySource(clip.id), {}, clip),
        QueryDescriptors(upload, {}, None, stored_as=clip),
    ):
        assert query.excluded_clips(include_self=False) == {clip.id}
        assert query.excluded_clips(include_self=True) == frozenset()
    new = QueryDescriptors(upload, {}, None)
    assert new.excluded_clips(include_self=False) == frozenset()


def test_a_file_that_is_stored_already_is_recognized(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    clip = ready_clips[0]
    content = ready_library.store.files.path(clip.sha256).read_bytes()

    def stored_as(content: bytes, **hints: Any) -> ClipRecord | None:
        source = QuerySource(content=io.BytesIO(content), **hints)
        return describe(ready_library, source, ("features_10hz",)).stored_as

    assert stored_as(content) == clip
    assert stored_as(content, start=0.5, end=1.0) == clip
    assert stored_as(content + b"\n") is None
