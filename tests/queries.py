"""Queries of tests. One call takes the fields of the source and of the search."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from app.services.find.queries import MotionQuery, PoseQuery
from app.services.find.query_source import QuerySource

_OF_SOURCE = {field.name for field in fields(QuerySource)}


def motion_query(**given: Any) -> MotionQuery:
    """A search by example."""
    source, rest = _split(given)
    return MotionQuery(QuerySource(**source), **rest)


def pose_query(**given: Any) -> PoseQuery:
    """A search by pose; its source is None if neither a clip nor a file is given."""
    source, rest = _split(given)
    has_motion = source.get("clip_id") is not None or source.get("content") is not None
    return PoseQuery(QuerySource(**source) if has_motion else None, **rest)


def _split(given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    source = {name: value for name, value in given.items() if name in _OF_SOURCE}
    return source, {name: value for name, value in given.items() if name not in _OF_SOURCE}
