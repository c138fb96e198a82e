"""manifest.csv: what a library's owner says about the files beside it.

Columns: `path` (relative to the manifest), and any of `name person task words license source fps
unit up_axis keyposes audio audio_offset tempo beats`; `frame_rate` is another name of `fps`. Words
are separated by spaces, a phrase has underscores; keyposes and beats are seconds, separated by
spaces; audio is a path like `path`. Other columns are ignored. A row that cannot be used is kept
with its problem, which is reported with its file.

A manifest is read as a stream, by `manifest_table`; what is kept of a row is its text, and that
is understood when its file's turn comes.
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
    Readable,
    Used,
    read_rows,
    too_long_path,
)
from app.store.clips.record import AnalysisHints, ClipLabels

FPS = "fps"
"""Another name of the column `frame_rate`, which it goes before."""
NO_COLUMN = ("roles", "stack")
"""Hints that a manifest has no column for."""
HINTS = tuple(hint for hint in fields.HINTS if hint not in NO_COLUMN)
KNOWN = (*fields.LABELS, FPS, *HINTS, "keyposes")
"""The columns that are kept of a row, beside its `path` and `audio`."""


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """What a manifest says about one file; `problem` where the row cannot be used.

    line: 0 where no manifest names the file; keyposes: seconds; audio: path of a recording, seen
    from where `path` is.
    """

    line: int
    labels: ClipLabels
    hints: AnalysisHints = field(default_factory=AnalysisHints)
    keyposes: tuple[float, ...] | None = None
    audio: str | None = None
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
        """What is said about a file, which is called by its path where no name is said."""
        kept = self._rows.get(path)
        name = fields.stem(fields.file_name(path))
        if kept is None:
            return ManifestRow(0, ClipLabels(name))
        if kept.cells is None:
            return ManifestRow(kept.line, ClipLabels(name), problem=_repeated(kept.line))
        return _row(kept, kept.cells, name)

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


def _row(kept: _Kept, cells: tuple[str, ...], default_name: str) -> ManifestRow:
    said = dict(zip(kept.columns.names, cells, strict=True))
    if fps := said.pop(FPS, None):
        said["frame_rate"] = fps
    named = said.pop("keyposes", None)
    try:
        labels, hints = fields.labels_and_hints(said, default_name)
        keyposes = fields.keyposes(named) or None
    except BadField as problem:
        return ManifestRow(kept.line, ClipLabels(default_name), problem=_unusable(kept, problem))
    return ManifestRow(kept.line, labels, hints, keyposes, kept.audio)


def _unusable(kept: _Kept, problem: BadField) -> BadField:
    where = f"{MANIFEST_NAME} line {kept.line}"
    return BadField(
        f"Line {kept.line} of {MANIFEST_NAME} cannot be used: {problem.detail}",
        places=[Place(f"{where}: {p.location}", p.message) for p in problem.places],
    )


def _repeated(line: int) -> BadField:
    message = "this path stands in an earlier line already"
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return BadField(f"{MANIFEST_NAME}: {message}.", places=[place])
