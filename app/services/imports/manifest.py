"""manifest.csv: the labels, hints, keyposes and recordings of the files in an import.

Columns: `path` (relative to the manifest), and any of `name person task words license source
fps unit up_axis keyposes audio audio_offset tempo beats`; `frame_rate` is another name of `fps`.
Words are separated by spaces, a phrase has underscores; keyposes and beats are seconds, separated
by spaces; audio is a path like `path`. Other columns are ignored. A bad row does not fail the
import: its problem is reported with its file.

`manifest_table` reads a manifest as a stream. Only the text of each row is kept in memory; it is
checked when its file is registered.
"""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from dataclasses import dataclass, field

from app.errors import BadField, KinedexError, Place
from app.services import fields
from app.services.imports.manifest_table import (
    MANIFEST_NAME,
    Columns,
    ManifestLimits,
    ManifestUsage,
    Readable,
    read_rows,
    too_long_path,
)
from app.store.clips.record import AnalysisHints, ClipLabels

FPS = "fps"
"""Another name of the column `frame_rate`. If a manifest has both columns, `fps` counts."""
NO_COLUMN = ("roles", "stack")
"""Hints that have no column in a manifest."""
HINTS = tuple(hint for hint in fields.HINTS if hint not in NO_COLUMN)
COLUMNS = (*fields.LABELS, FPS, *HINTS, "keyposes")
"""The columns of a row that are read, besides `path` and `audio`."""


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """The row of one file.

    line: 0 if no manifest names the file; keyposes: seconds; audio: path of a recording, from the
    root of the import; problem: why the row cannot be used, else None.
    """

    line: int
    labels: ClipLabels
    hints: AnalysisHints = field(default_factory=AnalysisHints)
    keyposes: tuple[float, ...] | None = None
    audio: str | None = None
    problem: KinedexError | None = None


@dataclass(frozen=True, slots=True)
class _RowText:
    """A row as text. cells: in the columns of COLUMNS; None if the manifest repeats the path."""

    columns: Columns
    line: int
    audio: str | None
    cells: tuple[str, ...] | None


class Manifest:
    """The rows of all manifests of one import; all paths are from the root of the import."""

    def __init__(self, limits: ManifestLimits) -> None:
        self._usage = ManifestUsage(limits)
        self._rows: dict[str, _RowText] = {}

    def read(self, content: Readable, folder: str = "") -> None:
        """Add the rows of one manifest; folder: the folder that it is in.

        If two manifests name a path, the later row counts. Raises Unreadable if the content is
        not a table with a column of paths, and TooLarge beyond a limit; both name the line.
        """
        columns: Columns | None = None
        for columns, line, cells in read_rows(content, self._usage, COLUMNS):
            path = _path(folder, columns.cell(cells, "path"), line)
            audio = columns.cell(cells, "audio")
            before = self._rows.get(path)
            # Each manifest has its own Columns object, so this is a repetition in one manifest.
            is_repeated = before is not None and before.columns is columns
            self._rows[path] = _RowText(
                columns,
                line,
                _path(folder, audio, line) if audio and not is_repeated else None,
                None if is_repeated else columns.named_cells(cells),
            )

    def row(self, path: str) -> ManifestRow:
        """The row of a file. A clip without a name gets the name of its file."""
        text = self._rows.get(path)
        name = fields.stem(fields.file_name(path))
        if text is None:
            return ManifestRow(0, ClipLabels(name))
        if text.cells is None:
            return ManifestRow(text.line, ClipLabels(name), problem=_repeated(text.line))
        return _row(text, text.cells, name)

    def recordings(self) -> dict[str, int]:
        """The line that names each recording, by the recording's path."""
        return {row.audio: row.line for row in self._rows.values() if row.audio is not None}

    def named(self) -> Iterator[tuple[str, int]]:
        """The paths of all recordings and motions, each with the line that names it."""
        yield from self.recordings().items()
        yield from ((path, row.line) for path, row in self._rows.items())


def _path(folder: str, cell: str, line: int) -> str:
    path = posixpath.normpath(posixpath.join(folder, cell.replace("\\", "/")))
    if len(path) > fields.MAX_PATH:
        raise too_long_path(line, fields.MAX_PATH)
    return path


def _row(text: _RowText, cells: tuple[str, ...], default_name: str) -> ManifestRow:
    values = dict(zip(text.columns.names, cells, strict=True))
    if fps := values.pop(FPS, None):
        values["frame_rate"] = fps
    times = values.pop("keyposes", None)
    try:
        labels, hints = fields.labels_and_hints(values, default_name)
        keyposes = fields.keyposes(times) or None
    except BadField as problem:
        return ManifestRow(text.line, ClipLabels(default_name), problem=_unusable(text, problem))
    return ManifestRow(text.line, labels, hints, keyposes, text.audio)


def _unusable(text: _RowText, problem: BadField) -> BadField:
    where = f"{MANIFEST_NAME} line {text.line}"
    return BadField(
        f"Line {text.line} of {MANIFEST_NAME} cannot be used: {problem.detail}",
        places=[Place(f"{where}: {p.location}", p.message) for p in problem.places],
    )


def _repeated(line: int) -> BadField:
    message = "an earlier line has the same path"
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return BadField(f"{MANIFEST_NAME}: {message}.", places=[place])
