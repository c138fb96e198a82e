"""The annotations of a clip: read, replaced, added, corrected, deleted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from app.services import fields
from app.services.annotations.checks import CHANGEABLE, MAX_ANNOTATIONS, checked, checked_all
from app.services.library.library import Library
from app.store import audit
from app.store.clips import clip_annotations as stored
from app.store.clips import repository as clips
from app.store.clips.clip_annotations import Annotation, NewAnnotation


def list_annotations(lib: Library, clip_id: str) -> tuple[Annotation, ...]:
    """The annotations of a clip, by start. Raises ClipNotFound."""
    with lib.store.read() as tx:
        return stored.of_clip(tx, clip_id)


def get_annotation(lib: Library, clip_id: str, annotation_id: str) -> Annotation:
    """One annotation of a clip. Raises ClipNotFound, AnnotationNotFound."""
    with lib.store.read() as tx:
        return stored.get(tx, clip_id, annotation_id)


def replace_annotations(
    lib: Library, clip_id: str, values: Sequence[Mapping[str, Any]]
) -> tuple[Annotation, ...]:
    """Replace all annotations of a clip; values: each by the names of `checks.CHANGEABLE`.

    The next fit learns from them. Raises ClipNotFound, and BadField with the place.
    """
    return store_all(lib, clip_id, checked_all(values, _seconds(lib, clip_id)))


def store_all(lib: Library, clip_id: str, new: Sequence[NewAnnotation]) -> tuple[Annotation, ...]:
    """Replace all annotations of a clip by checked ones. Raises ClipNotFound."""
    with lib.store.write() as tx:
        audit.note(annotations=len(new))
        stored.put(tx, clip_id, new)
        return stored.of_clip(tx, clip_id)


def add_annotation(lib: Library, clip_id: str, values: Mapping[str, Any]) -> Annotation:
    """Add an annotation to a clip. Raises ClipNotFound, BadField."""
    new = checked(values, _seconds(lib, clip_id))
    with lib.store.write() as tx:
        check_count(stored.count(tx, clip_id) + 1)
        added = stored.add(tx, clip_id, new)
        audit.note(annotation_id=added.id)
        return added


def change_annotation(
    lib: Library, clip_id: str, annotation_id: str, changes: Mapping[str, Any]
) -> Annotation:
    """Correct what an annotation says; what is not named stays.

    Raises ClipNotFound, AnnotationNotFound, BadField.
    """
    seconds = _seconds(lib, clip_id)
    with lib.store.write() as tx:
        audit.note(fields=sorted(changes))
        before = stored.get(tx, clip_id, annotation_id)
        values = {name: getattr(before, name) for name in CHANGEABLE} | dict(changes)
        # A correction is what a person says, whatever was said before.
        return stored.change(tx, clip_id, annotation_id, checked(values, seconds))


def delete_annotation(lib: Library, clip_id: str, annotation_id: str) -> None:
    """Delete an annotation. Raises ClipNotFound, AnnotationNotFound."""
    with lib.store.write() as tx:
        stored.remove(tx, clip_id, annotation_id)


def check_count(count: int) -> None:
    """Raise BadField if a clip may not have so many annotations."""
    if count > MAX_ANNOTATIONS:
        raise fields.bad_field("items", f"a clip has at most {MAX_ANNOTATIONS} annotations")


def _seconds(lib: Library, clip_id: str) -> float | None:
    """The length of a clip; None before its analysis. Raises ClipNotFound."""
    with lib.store.read() as tx:
        return clips.get(tx, clip_id).duration
