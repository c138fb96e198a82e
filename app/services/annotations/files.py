"""Annotations of clips as files: CSV, ELAN (`.eaf`) and BABEL (JSON)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from app.errors import BadContent, TooLarge
from app.formats.annotations import babel, eaf, table
from app.formats.annotations.span import MAX_FILE_BYTES, Span
from app.kinedex_error import Place
from app.services import fields
from app.services.annotations.checks import of_spans
from app.services.annotations.clip_annotations import list_annotations, store_all
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.store.clips import clip_annotations as stored
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.clip_annotations import Annotation
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.files.files import Readable


class AnnotationFormat(StrEnum):
    """A format of files of annotations."""

    CSV = "csv"
    """Comma-separated values: clip, start, end, words, person, text, by."""
    EAF = "eaf"
    """ELAN."""
    BABEL = "babel"
    """JSON of BABEL."""


@dataclass(frozen=True, slots=True)
class AnnotationFile:
    """A file of annotations, and its name."""

    name: str
    content: bytes


ENDINGS = {
    AnnotationFormat.CSV: ".annotations.csv",
    AnnotationFormat.EAF: ".eaf",
    AnnotationFormat.BABEL: ".babel.json",
}


def export_annotations(lib: Library, clip_id: str, format: AnnotationFormat) -> AnnotationFile:
    """The annotations of a clip as a file. Raises ClipNotFound."""
    found = list_annotations(lib, clip_id)
    with lib.store.read() as tx:
        clip = clips.get(tx, clip_id)
    spans = [as_span(one) for one in found]
    content = {
        AnnotationFormat.CSV: lambda: table.write_table((_path(clip), one) for one in spans),
        AnnotationFormat.EAF: lambda: eaf.write_eaf(spans),
        AnnotationFormat.BABEL: lambda: babel.write_babel(spans, clip.duration),
    }[format]()
    return AnnotationFile(fields.stem(clip.file_name) + ENDINGS[format], content)


def export_library(lib: Library, filter: ClipFilter | None = None) -> Iterator[bytes]:
    """The annotations of all clips that pass a filter as one CSV file, by path.

    An import reads it again as `annotations.csv` in the root of the same folders. Raises BadField,
    before the first block.
    """
    return _blocks(lib, resolved_filter(lib, filter))


def _blocks(lib: Library, passing: ClipFilter) -> Iterator[bytes]:
    with lib.store.read() as tx:
        ids, _ = clip_listing.ids_by_path(tx, passing)
    yield table.write_table([])
    head = len(table.write_table([]))
    for batch in clips.in_batches(ids):
        with lib.store.read() as tx:
            records, found = clips.get_many(tx, batch), stored.get_many(tx, batch)
        rows = [
            (_path(records[clip_id]), as_span(one))
            for clip_id in batch
            if clip_id in records
            for one in found.get(clip_id, ())
        ]
        if rows:
            yield table.write_table(rows)[head:]


def import_annotations(
    lib: Library, clip_id: str, content: Readable, format: AnnotationFormat
) -> tuple[Annotation, ...]:
    """Replace the annotations of a clip by those of a file.

    Raises ClipNotFound, Unreadable, TooLarge, and BadField with the place in the file.
    """
    with lib.store.read() as tx:
        clip = clips.get(tx, clip_id)
    read = content.read(MAX_FILE_BYTES + 1)
    if len(read) > MAX_FILE_BYTES:
        raise TooLarge(f"A file of annotations has at most {MAX_FILE_BYTES} bytes.")
    spans = _spans(read, format, clip)
    return store_all(lib, clip_id, of_spans(spans, clip.duration))


def as_span(one: Annotation) -> Span:
    """An annotation as files hold it."""
    return Span(one.start, one.end, one.words, one.person, one.text, one.by)


def _spans(content: bytes, format: AnnotationFormat, clip: ClipRecord) -> Sequence[Span]:
    if format is AnnotationFormat.EAF:
        return eaf.read_eaf(content)
    if format is AnnotationFormat.CSV:
        return list(_own(table.read_table(content), clip))
    found = babel.read_babel(content, clip.duration)
    if len(found) == 1:
        return found[0].spans
    own = [one for one in found if is_named(one.path or "", clip)]
    if len(own) != 1:
        message = f"{len(found)} sequences, and {len(own)} of them have the clip's name"
        raise BadContent("The file has no single sequence of this clip.", places=[
            Place("feat_p", message)
        ])  # fmt: skip
    return own[0].spans


def _own(rows: Iterable[tuple[str, Span]], clip: ClipRecord) -> Iterator[Span]:
    """The spans of rows that name the clip or none. Raises BadContent for another clip."""
    for name, span in rows:
        if name and name != clip.id and not is_named(name, clip):
            place = Place(span.place, f"{name!r:.200} is another clip")
            raise BadContent("The table has annotations of another clip.", places=[place])
        yield span


def is_named(name: str, clip: ClipRecord) -> bool:
    """Whether a file means a clip by its id, its name, its path or the end of its path."""
    return name in (clip.id, clip.name, clip.path, clip.file_name) or _path(clip).endswith(
        f"/{name}"
    )


def _path(clip: ClipRecord) -> str:
    return clip.path or clip.file_name
