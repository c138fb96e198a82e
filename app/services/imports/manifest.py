"""manifest.csv: what a library's owner says about the files beside it.

Columns: `path` (relative to the manifest), and any of `name person task words license source
fps unit keyposes audio audio_offset tempo beats`; words are separated by spaces, a phrase has
underscores; keyposes and beats are seconds, separated by spaces; audio is a path like `path`.
Other columns are left alone. Rows that cannot be used are kept with their problem, to be told
with their file.

A manifest is read as a stream, by `manifest_table`; what is kept of a row is its text, and that
is understood when its file's turn comes.
"""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from dataclasses import dataclass

from app.errors import BadField, KinedexError, Place
from app.services import fields
from app.services.imports.manifest_table import (
    MANIFEST_NAME,
    Columns,
    ManifestLimits,
    Readable,
    Used,
    read_rows,
    too_long_path,
)

LABELS = ("name", "person", "task", "words", "license", "source")
NUMBERS = ("fps", "frame_rate", "unit", "audio_offset", "tempo")
TIMES = ("keyposes", "beats")
KNOWN = (*LABELS, *NUMBERS, *TIMES)
"""The columns that are kept of a row, beside its `path` and `audio`."""


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


@dataclass(frozen=True, slots=True)
class _Kept:
    """A row as text. cells: those of the manifest's known columns; None where it is repeated."""

    columns: Columns
    line: int
    audio: str | None
    cells: tuple[str, ...] | None


class Manifest:
    """What the manifests of one import say about its files; paths are seen from its root."""

    def __init__(self, limits: ManifestLimits) -> None:
        self._used = Used(limits)
        self._rows: dict[str, _Kept] = {}

    def read(self, content: Readable, folder: str = "") -> None:
        """Add the rows of one manifest, whose own folder is `folder`.

        Of two manifests that name a path, the later counts. Raises Unreadable where the whole
        is no such table, and TooLarge beyond a limit; both name the line.
        """
        columns: Columns | None = None
        for columns, line, cells in read_rows(content, self._used, KNOWN):
            path = _path(folder, columns.of(cells, "path"), line)
            audio = columns.of(cells, "audio")
            before = self._rows.get(path)
            is_repeated = before is not None and before.columns is columns
            self._rows[path] = _Kept(
                columns,
                line,
                _path(folder, audio, line) if audio and not is_repeated else None,
                None if is_repeated else columns.known(cells),
            )

    def row(self, path: str) -> ManifestRow:
        """What is said about a file; an empty row where nothing is."""
        kept = self._rows.get(path)
        if kept is None:
            return ManifestRow(line=0)
        return _repeated(kept.line) if kept.cells is None else _row(kept, kept.cells)

    def recordings(self) -> dict[str, int]:
        """The line that names each recording, by the recording's path."""
        return {row.audio: row.line for row in self._rows.values() if row.audio is not None}

    def named(self) -> Iterator[tuple[str, int]]:
        """Every path that is named, a recording's too, with the line that names it."""
        yield from self.recordings().items()
        yield from ((path, row.line) for path, row in self._rows.items())


def _path(folder: str, written: str, line: int) -> str:
    path = posixpath.normpath(posixpath.join(folder, written.replace("\\", "/")))
    if len(path) > fields.MAX_PATH:
        raise too_long_path(line, fields.MAX_PATH)
    return path


def _row(kept: _Kept, cells: tuple[str, ...]) -> ManifestRow:
    line = kept.line
    said = dict(zip(kept.columns.names, cells, strict=True))
    try:
        return ManifestRow(
            line=line,
            name=fields.text("name", said.get("name")),
            person=fields.text("person", said.get("person")),
            task=fields.text("task", said.get("task")),
            words=fields.words(said.get("words")) or None,
            license=fields.text("license", said.get("license")),
            source=fields.text("source", said.get("source")),
            frame_rate=fields.frame_rate(said.get("fps") or said.get("frame_rate")),
            metres_per_unit=fields.metres_per_unit(said.get("unit")),
            keyposes=fields.keyposes(said.get("keyposes")) or None,
            audio=kept.audio,
            audio_offset=fields.audio_offset(said.get("audio_offset")),
            tempo=fields.tempo(said.get("tempo")),
            beats=fields.beats(said.get("beats")),
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
