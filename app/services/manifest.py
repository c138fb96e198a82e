"""manifest.csv: what a library's owner says about the files beside it.

Columns: `path` (relative to the manifest), and any of `name person task words license source
fps unit keyposes audio audio_offset tempo beats`; words are separated by spaces, a phrase has
underscores; keyposes and beats are seconds, separated by spaces; audio is a path like `path`.
Other columns are left alone. Rows that cannot be used are kept with their problem, to be told
with their file.
"""

from __future__ import annotations

import csv
import io
import posixpath
from collections.abc import Iterator
from dataclasses import dataclass

from app.errors import BadField, KinedexError, Place, Unreadable
from app.services import fields

MANIFEST_NAME = "manifest.csv"
MAX_MANIFEST_BYTES = 64 * 2**20


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """What a manifest says about one file; `problem` where the row cannot be used.

    audio: path of a recording, seen from where `path` is.
    """

    line: int
    name: str | None = None
    person: str | None = None
    task: str | None = None
    words: tuple[str, ...] | None = None
    license: str | None = None
    source: str | None = None
    frame_rate: float | None = None
    metres_per_unit: float | None = None
    keyposes: tuple[float, ...] | None = None
    audio: str | None = None
    audio_offset: float | None = None
    tempo: float | None = None
    beats: tuple[float, ...] | None = None
    problem: KinedexError | None = None


def read_manifest(content: bytes, folder: str = "") -> dict[str, ManifestRow]:
    """Rows by the path of their file, seen from where `folder` (the manifest's own) is seen.

    Raises Unreadable, naming the line, where the whole file is no such table.
    """
    if len(content) > MAX_MANIFEST_BYTES:
        raise _unreadable(1, f"larger than {MAX_MANIFEST_BYTES} bytes")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = content[: problem.start].count(b"\n") + 1
        raise _unreadable(line, "not UTF-8 text") from problem
    rows: dict[str, ManifestRow] = {}
    for line, record in _records(text):
        path = _path(folder, record["path"])
        rows[path] = _repeated(line) if path in rows else _row(line, record, folder)
    return rows


def _records(text: str) -> Iterator[tuple[int, dict[str, str]]]:
    head = text.partition("\n")[0]
    reader = csv.DictReader(
        io.StringIO(text, newline=""),
        # Spreadsheets of many countries write semicolons; a tie is a table of one column.
        delimiter=max(",;\t", key=head.count),
        skipinitialspace=True,
        strict=True,
    )
    try:
        names = [(name or "").strip().lower() for name in reader.fieldnames or ()]
        if "path" not in names:
            raise _unreadable(1, "the first line must name the columns, `path` among them")
        reader.fieldnames = names
        for record in reader:
            if (record.get("path") or "").strip():
                tidy = {k: (v or "").strip() for k, v in record.items() if isinstance(k, str)}
                yield reader.line_num, tidy
    except csv.Error as problem:
        raise _unreadable(reader.reader.line_num, str(problem)) from problem


def _path(folder: str, written: str) -> str:
    return posixpath.normpath(posixpath.join(folder, written.replace("\\", "/")))


def _row(line: int, record: dict[str, str], folder: str) -> ManifestRow:
    try:
        return ManifestRow(
            line=line,
            name=fields.text("name", record.get("name")),
            person=fields.text("person", record.get("person")),
            task=fields.text("task", record.get("task")),
            words=fields.words(record.get("words")) or None,
            license=fields.text("license", record.get("license")),
            source=fields.text("source", record.get("source")),
            frame_rate=fields.frame_rate(record.get("fps") or record.get("frame_rate")),
            metres_per_unit=fields.metres_per_unit(record.get("unit")),
            keyposes=fields.keyposes(record.get("keyposes")) or None,
            audio=_path(folder, record["audio"]) if record.get("audio") else None,
            audio_offset=fields.audio_offset(record.get("audio_offset")),
            tempo=fields.tempo(record.get("tempo")),
            beats=fields.beats(record.get("beats")),
        )
    except BadField as problem:
        places = [
            Place(f"{MANIFEST_NAME} line {line}: {p.location}", p.message) for p in problem.places
        ]
        return ManifestRow(
            line,
            problem=BadField(
                f"Line {line} of {MANIFEST_NAME} cannot be used: {problem.detail}", places=places
            ),
        )


def _repeated(line: int) -> ManifestRow:
    message = "this path stands in an earlier line already"
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return ManifestRow(line, problem=BadField(f"{MANIFEST_NAME}: {message}.", places=[place]))


def _unreadable(line: int, message: str) -> Unreadable:
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return Unreadable(f"{MANIFEST_NAME} cannot be read: {message}.", places=[place])
