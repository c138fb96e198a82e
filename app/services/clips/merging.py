"""The labels and hints that come with content that the library has already.

Three values count for each field: the one that came with the file before (the base), the stored
one, and the one that comes now. If the stored value is still the base, nobody edited it, and a new
value replaces it. If the stored value is another one, somebody edited it since: a new value is a
conflict. If the value that comes now is the base, nothing new came, and the edit stays.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from app.errors import Conflict
from app.kinedex_error import Place
from app.services import clip_fields
from app.store.clips.record import META, ClipRecord, Difference, NewClip
from app.store.clips.rows import flat, sent_values

MAX_SHOWN = 100
"""Characters of a value in the message of a failure."""


class OnConflict(StrEnum):
    """What happens to labels and hints that differ from those of a stored clip."""

    KEEP = "keep"
    """The stored values stay."""
    UPDATE = "update"
    """The sent values replace them."""
    ERROR = "error"
    """The request is refused, and nothing changes."""
    MERGE = "merge"
    """The sent values replace them, except those that somebody edited since they came."""


@dataclass(frozen=True, slots=True)
class Merge:
    """The result of `merge`. changes: for `repository.patch`."""

    differences: tuple[Difference, ...]
    changes: Mapping[str, Any]


def merge(clip: ClipRecord, new: NewClip, policy: OnConflict, paths: Collection[str] = ()) -> Merge:
    """Compare what came with a file to its stored clip.

    paths: of all files that came together. Raises Conflict, with the fields, if the policy is ERROR
    and any field differs.
    """
    stored, base = flat(clip, clip.hints), dict(clip.imported)
    differences = []
    for name, sent in sent_values(new).items():
        ours = stored.get(name)
        if sent == ours:
            base[name] = sent
            continue
        if policy is OnConflict.MERGE and sent == base.get(name):
            continue  # edited since, and nothing new came
        is_edited = ours != base.get(name)
        is_applied = policy is OnConflict.UPDATE or (policy is OnConflict.MERGE and not is_edited)
        differences.append(Difference(clip_fields.client_name(name), ours, sent, is_applied))
        if is_applied:
            base[name] = sent
    if policy is OnConflict.ERROR and differences:
        raise _conflict(clip, differences)
    changes = _changes(clip, new, differences, base, policy)
    if has_moved(clip, new.path, paths) and policy in (OnConflict.MERGE, OnConflict.UPDATE):
        differences.append(Difference("path", clip.path, new.path, applied=True))
        changes["path"] = new.path
    return Merge(tuple(differences), changes)


def has_moved(clip: ClipRecord, path: str | None, paths: Collection[str]) -> bool:
    """Whether the file of a clip has another path now.

    It has not moved if its old path is one of `paths`, since then there are two files with the same
    content. Nor has it if the new path is the end of the old one: then a folder of an earlier
    import is imported on its own.
    """
    if path is None or path == clip.path:
        return False
    return clip.path is None or not (clip.path in paths or clip.path.endswith(f"/{path}"))


def _changes(
    clip: ClipRecord,
    new: NewClip,
    differences: list[Difference],
    base: Mapping[str, Any],
    policy: OnConflict,
) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    applied = {
        difference.field: difference.sent for difference in differences if difference.applied
    }
    for name in new.sent:
        if clip_fields.client_name(name) not in applied:
            continue
        if name.startswith(META):
            key = name.removeprefix(META)
            changes.setdefault("metadata", {})[key] = applied[name]
        else:
            changes[name] = _typed(new, name)
    if policy is not OnConflict.KEEP and base != clip.imported:
        changes["imported"] = base
    return changes


def _typed(new: NewClip, name: str) -> Any:
    """The value as `ClipChanges` has it, with tuples instead of JSON's lists."""
    holder = new.labels if hasattr(new.labels, name) else new.hints
    return getattr(holder, name)


def _conflict(clip: ClipRecord, differences: list[Difference]) -> Conflict:
    return Conflict(
        f"The library has this content already, as the clip {clip.id}, with other values.",
        places=[
            Place(one.field, f"is {_shown(one.stored)}, not {_shown(one.sent)}")
            for one in differences
        ],
    )


def _shown(value: Any) -> str:
    return "nothing" if value is None else repr(value)[:MAX_SHOWN]
