"""Groups of the clips that are judged, by a label or by the metadata: figures for each group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from app.services import fields
from app.services.evaluations.options import LABELS
from app.store.clips.metadata_values import as_text
from app.store.clips.record import META, ClipRecord

NO_VALUE = "(none)"
"""The group of the clips without a value."""
MAX_GROUPS = 100
"""Largest number of groups with figures; the largest groups are shown."""

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Grouping:
    """How clips are grouped. by: one of LABELS, or `meta.KEY`."""

    by: str

    @classmethod
    def of(cls, by: str | None) -> Grouping | None:
        """The grouping by a name; None without a name. Raises BadField for an unknown one."""
        if by is not None and by not in LABELS and not by.startswith(META):
            raise fields.bad_field("by", f"must be {META}KEY or one of {', '.join(LABELS)}")
        return None if by is None else cls(by)

    def group(self, clip: ClipRecord) -> str:
        """The group of a clip."""
        if self.by.startswith(META):
            value = clip.metadata.get(self.by.removeprefix(META))
            return NO_VALUE if value is None else as_text(value)
        return getattr(clip, self.by) or NO_VALUE

    def groups(self, clips: Sequence[ClipRecord]) -> list[str]:
        """The group of each clip. Raises BadField if no clip has the key of the metadata."""
        found = [self.group(clip) for clip in clips]
        if clips and self.by.startswith(META) and set(found) == {NO_VALUE}:
            keys = sorted({key for clip in clips for key in clip.metadata})
            known = f"their keys are {', '.join(keys)}" if keys else "they have no metadata"
            raise fields.bad_field(
                "by", f"no clip has {self.by.removeprefix(META)!r} in its metadata; {known}"
            )
        return found


def grouped(groups: Sequence[str], items: Sequence[Item]) -> dict[str, list[Item]]:
    """The items of each group, the largest group first; groups: the group of each item."""
    found: dict[str, list[Item]] = {}
    for group, item in zip(groups, items, strict=True):
        found.setdefault(group, []).append(item)
    largest = sorted(found, key=lambda group: (-len(found[group]), group))[:MAX_GROUPS]
    return {group: found[group] for group in largest}
