"""The fields that name the motion of a query."""

from __future__ import annotations

from dataclasses import fields as fields_of

from pydantic import Field, Json

from app.api.schemas.base import Id, Incoming, Roles
from app.api.schemas.clips import FrameRate, Stack
from app.services.find.query_source import QuerySource
from app.store.files.files import Readable

ClipId = Id

_NAMES = {field.name for field in fields_of(QuerySource)}


class QueryFields(Incoming):
    """A body with a motion as its query: the fields that a `QuerySource` also has."""

    def source(
        self, content: Readable | None = None, skeleton: Readable | None = None
    ) -> QuerySource:
        """The motion of the query; content, skeleton: the files that were sent with the body."""
        sent = {name: getattr(self, name) for name in _NAMES & type(self).model_fields.keys()}
        return QuerySource(**sent, content=content, skeleton=skeleton)


class QueryForm(QueryFields):
    """A form with a stored clip or an uploaded file, and what a client may say of the file."""

    clip_id: ClipId | None = None
    unit: str | None = Field(
        None,
        max_length=30,
        description="m, dm, cm, mm, in, ft, cmu (of CMU's files), or meters per unit.",
    )
    frame_rate: FrameRate | None = Field(None, description="Overrides what the file declares.")
    roles: Json[Roles] | None = Field(
        None, description='JSON: joint name by role, as {"hips": "Pelvis"}.'
    )
    stack: Stack | None = None
