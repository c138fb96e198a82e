"""The motion of a query, for searches and recognition."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.store.files.files import Readable

UPLOAD_ONLY = ("skeleton", "frame_rate", "unit", "up_axis", "roles", "stack")
"""Fields of a QuerySource that describe an uploaded file. A stored clip has its own."""


@dataclass(frozen=True, slots=True)
class QuerySource:
    """A stored clip or an uploaded file, the selected part of it, and the client's hints.

    Exactly one of `clip_id` and `content` must be given; `describe` checks it.

    start, end: seconds, the selected part; None is the motion's own start or end.
    skeleton: the ASF file that an AMC file needs; frame_rate: Hz; unit: a name, or meters in one
    unit; up_axis: of the file; roles: joint names by role; stack: the animation stack of an FBX
    file.
    """

    clip_id: str | None = None
    content: Readable | None = None
    start: float | None = None
    end: float | None = None
    skeleton: Readable | None = None
    frame_rate: float | str | None = None
    unit: float | str | None = None
    up_axis: str | None = None
    roles: Mapping[str, str | list[str]] | None = None
    stack: str | None = None

    @property
    def is_whole(self) -> bool:
        """Whether the whole motion is selected."""
        return self.start is None and self.end is None
