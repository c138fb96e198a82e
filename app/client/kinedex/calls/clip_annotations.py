"""Calls: clip annotations. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinedex.call import Call, nothing, path_of, read_bytes, record
from kinedex.sent import UNSET, FileInput, Progress, Unset, corrections, given

if TYPE_CHECKING:
    from kinedex.types.annotations import Annotation, Annotations, AnnotationSuggestions
    from kinedex.types.bodies import AcceptedSpan, NewAnnotation
    from kinedex.types.choices import AnnotationFormat


def list_annotations(clip_id: str) -> Call[Annotations]:
    """The annotations of a clip: what is said about its parts, by start."""
    from kinedex.types.annotations import Annotations

    return Call(
        "list_annotations",
        "GET",
        path_of("/v1/clips/{clip_id}/annotations", clip_id=clip_id),
        record(Annotations),
    )


def add_annotation(
    clip_id: str,
    start: float,
    end: float,
    *,
    words: Sequence[str] | None = None,
    person: str | None = None,
    text: str | None = None,
    by: str | None = None,
) -> Call[Annotation]:
    """Add an annotation to a clip.

    start: Start of the part, seconds from the start of the clip.
    end: End of the part, seconds.
    words: What happens in the part. A phrase is one word, joined by underscores (`left_leg`).
        Default: [].
    person: Who moves in the part, if it is not the person of the clip.
    text: A sentence that describes the part.
    by: Who said it.
    """
    from kinedex.types.annotations import Annotation

    return Call(
        "add_annotation",
        "POST",
        path_of("/v1/clips/{clip_id}/annotations", clip_id=clip_id),
        record(Annotation),
        json=given(start=start, end=end, words=words, person=person, text=text, by=by),
    )


def replace_annotations(clip_id: str, items: Sequence[NewAnnotation]) -> Call[Annotations]:
    """Replace all annotations of a clip.

    The next fit learns from them: each part with words is a sample of its own. The words and the
    task of a clip whose parts have words teach no model any more, since they are true of only
    some of its parts.
    """
    from kinedex.types.annotations import Annotations

    return Call(
        "replace_annotations",
        "PUT",
        path_of("/v1/clips/{clip_id}/annotations", clip_id=clip_id),
        record(Annotations),
        json=given(items=items),
    )


def get_annotation_file(clip_id: str, *, format: AnnotationFormat | None = None) -> Call[bytes]:
    """The annotations of a clip as CSV, for ELAN (`.eaf`), or as JSON of BABEL.

    format: csv: a table with the columns clip, start, end, words, person, text and by. eaf:
        ELAN, with the tiers words, person, text and by. babel: JSON of BABEL. Default: csv.
    """
    return Call(
        "get_annotation_file",
        "GET",
        path_of("/v1/clips/{clip_id}/annotations/file", clip_id=clip_id),
        read_bytes,
        query=given(format=format),
        accept="*/*",
    )


def put_annotation_file(
    clip_id: str,
    file: FileInput,
    *,
    format: AnnotationFormat | None = None,
    progress: Progress | None = None,
) -> Call[Annotations]:
    """Replace all annotations of a clip by those of a file: CSV, ELAN (`.eaf`) or BABEL (JSON).

    In an ELAN file, annotations of different tiers with the same times are one. The tiers
    `words`, `person`, `text` and `by` are what their names say; the values of any other tier are
    words.

    file: The annotations: CSV, ELAN or JSON of BABEL.
    format: csv: a table with the columns clip, start, end, words, person, text and by. eaf:
        ELAN, with the tiers words, person, text and by. babel: JSON of BABEL. Default: csv.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.annotations import Annotations

    return Call(
        "put_annotation_file",
        "PUT",
        path_of("/v1/clips/{clip_id}/annotations/file", clip_id=clip_id),
        record(Annotations),
        fields=given(format=format),
        files=given(file=file),
        progress=progress,
    )


def suggest_annotations(clip_id: str) -> Call[AnnotationSuggestions]:
    """Parts of a clip without annotation, with the words and the person that the models see."""
    from kinedex.types.annotations import AnnotationSuggestions

    return Call(
        "suggest_annotations",
        "GET",
        path_of("/v1/clips/{clip_id}/annotations/suggestions", clip_id=clip_id),
        record(AnnotationSuggestions),
    )


def accept_annotations(
    clip_id: str, *, items: Sequence[AcceptedSpan] | None = None, by: str | None = None
) -> Call[Annotations]:
    """Make annotations of suggestions: of those that the body names, or of all of them.

    items: Start and end of suggestions, as the list of suggestions has them.
    by: Who accepts them.
    """
    from kinedex.types.annotations import Annotations

    return Call(
        "accept_annotations",
        "POST",
        path_of("/v1/clips/{clip_id}/annotations/suggestions/accept", clip_id=clip_id),
        record(Annotations),
        json=given(items=items, by=by) or UNSET,
    )


def get_annotation(clip_id: str, annotation_id: str) -> Call[Annotation]:
    """One annotation."""
    from kinedex.types.annotations import Annotation

    return Call(
        "get_annotation",
        "GET",
        path_of(
            "/v1/clips/{clip_id}/annotations/{annotation_id}",
            clip_id=clip_id,
            annotation_id=annotation_id,
        ),
        record(Annotation),
    )


def update_annotation(
    clip_id: str,
    annotation_id: str,
    *,
    start: float | Unset | None = UNSET,
    end: float | Unset | None = UNSET,
    words: Sequence[str] | Unset | None = UNSET,
    person: str | Unset | None = UNSET,
    text: str | Unset | None = UNSET,
    by: str | Unset | None = UNSET,
) -> Call[Annotation]:
    """Correct an annotation. It then counts as made by a person.

    start: Start of the part, seconds from the start of the clip.
    end: End of the part, seconds.
    words: What happens in the part. A phrase is one word, joined by underscores (`left_leg`).
    person: Who moves in the part, if it is not the person of the clip.
    text: A sentence that describes the part.
    by: Who said it.
    """
    from kinedex.types.annotations import Annotation

    return Call(
        "update_annotation",
        "PATCH",
        path_of(
            "/v1/clips/{clip_id}/annotations/{annotation_id}",
            clip_id=clip_id,
            annotation_id=annotation_id,
        ),
        record(Annotation),
        json=corrections(start=start, end=end, words=words, person=person, text=text, by=by),
    )


def delete_annotation(clip_id: str, annotation_id: str) -> Call[None]:
    """Delete an annotation."""
    return Call(
        "delete_annotation",
        "DELETE",
        path_of(
            "/v1/clips/{clip_id}/annotations/{annotation_id}",
            clip_id=clip_id,
            annotation_id=annotation_id,
        ),
        nothing,
    )
