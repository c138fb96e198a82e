"""The fields that define the motion of a query."""

from __future__ import annotations

from dataclasses import fields as fields_of

from app.api.schemas.base import Id, Incoming
from app.api.schemas.clips import FileFrameRate, FormRoles, Stack, Unit, UpAxis
from app.services.find.query_source import QuerySource
from app.store.files.files import Readable

ClipId = Id

_NAMES = {field.name for field in fields_of(QuerySource)}


class QueryFields(Incoming):
    """A body with a motion as its query. A `QuerySource` has fields with the same names."""

    def source(
        self, content: Readable | None = None, skeleton: Readable | None = None
    ) -> QuerySource:
        """Return the motion of the query. content, skeleton: the files that came with the body."""
        sent = {name: getattr(self, name) for name in _NAMES & type(self).model_fields.keys()}
        return QuerySource(**sent, content=content, skeleton=skeleton)


class QueryForm(QueryFields):
    """A form with a stored clip or an uploaded file, and hints about the file."""

    clip_id: ClipId | None = None
    unit: Unit = None
    frame_rate: FileFrameRate = None
    up_axis: UpAxis | None = None
    roles: FormRoles = None
    stack: Stack | None = None
