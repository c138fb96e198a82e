"""manifest.csv: the labels, hints, metadata, keyposes and recordings of the files in an import.

Columns: `path` (relative to the manifest), and any of `name person task words license source
captions fps unit up_axis keyposes audio audio_offset tempo beats`; `frame_rate` is another name of
`fps`. Words are separated by spaces, a phrase has underscores; captions are separated by |;
keyposes and beats are seconds, separated by spaces; audio is a path like `path`. Any other column
is a key of the metadata (`columns`). A bad row does not fail the import: its problem is reported
with its file.

`manifest_table` reads a manifest as a stream. Only the text of each row is kept in memory; it is
checked when its file is registered.
"""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from app.errors import BadField
from app.kinedex_error import KinedexError, Place
from app.services import clip_fields, fields
from app.services.clip_fields import SentValues
from app.services.imports.columns import Columns
from app.services.imports.manifest_table import (
    MANIFEST_NAME,
    ManifestLimits,
    ManifestUsage,
    Readable,
    read_rows,
    too_long_path,
)
from app.services.imports.options import ImportOptions, combined
from app.store.clips.metadata_values import from_cell

FPS = "fps"
"""Another name of the column `frame_rate`. If a manifest has both columns, `fps` counts."""
NO_COLUMN = ("roles", "stack")
"""Hints that have no column in a manifest."""
HINTS = tuple(hint for hint in clip_fields.HINTS if hint not in NO_COLUMN)
LABELS = tuple(label for label in clip_fields.LABELS if label != "metadata")
COLUMNS = (*LABELS, FPS, *HINTS, "keyposes")
"""The columns of a row that are read, besides `path` and `audio`."""


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """The row of one file.

    line: 0 if no manifest names the file; values: its labels and hints, with those that the options
    of the import give; keyposes: seconds, None if the row has none; audio: path of a recording,
    from the root of the import; problem: why the row cannot be used, else None.
    """

    line: int
    values: SentValues
    keyposes: tuple[float, ...] | None = None
    audio: str | None = None
    problem: KinedexError | None = None


@dataclass(frozen=True, slots=True)
class _RowText:
    """A row as text.

    cells: in the columns of COLUMNS; None if the manifest repeats the path; metadata: in the
    columns of metadata.
    """

    columns: Columns
    line: int
    audio: str | None
    cells: tuple[str, ...] | None
    metadata: tuple[str, ...]

    def values(self) -> dict[str, Any]:
        """The values by field, as clients send them."""
        values: dict[str, Any] = dict(zip(self.columns.names, self.cells or (), strict=True))
        if fps := values.pop(FPS, None):
            values["frame_rate"] = fps
        cells = zip(self.columns.keys, self.metadata, strict=True)
        keys = {key: from_cell(cell) if cell else None for key, cell in cells}
        return values | ({"metadata": keys} if keys else {})


class Manifest:
    """The rows of all manifests of one import; all paths are from the root of the import."""

    def __init__(self, limits: ManifestLimits, options: ImportOptions | None = None) -> None:
        """options: values for files for which their rows say nothing. Raises BadField."""
        self._usage = ManifestUsage(limits)
        self._options = options or ImportOptions()
        self._pattern = self._options.path_pattern()
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
                columns.metadata_cells(cells),
            )

    def row(self, path: str) -> ManifestRow:
        """The row of a file. A clip without a name gets the name of its file."""
        text = self._rows.get(path)
        name = fields.stem(fields.file_name(path))
        given = combined(self._options.values, self._from_path(path) or {})
        try:
            if text is None:
                return ManifestRow(0, clip_fields.sent_values(given, name))
            if text.cells is None:
                raise _repeated(text.line)
            return _row(text, given, name)
        except BadField as problem:
            line = 0 if text is None else text.line
            return ManifestRow(line, clip_fields.sent_values({}, name), problem=problem)

    def is_matched(self, path: str) -> bool:
        """Whether the pattern of the options matches a path; True without a pattern."""
        return self._pattern is None or self._from_path(path) is not None

    def _from_path(self, path: str) -> dict[str, Any] | None:
        return None if self._pattern is None else self._pattern.values(path)

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


def _row(text: _RowText, given: Mapping[str, Any], default_name: str) -> ManifestRow:
    values = combined(given, text.values())
    times = values.pop("keyposes", None)
    try:
        said = clip_fields.sent_values(values, default_name)
        keyposes = fields.keyposes(times) or None
    except BadField as problem:
        raise _unusable(text, problem) from problem
    return ManifestRow(text.line, said, keyposes, text.audio)


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
