"""Converts a clip's values to columns of the table `clips`, and a row to a record.

Both directions use the fields of the dataclasses in `record`: a new label or hint there is stored
and read without a change here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from sqlalchemy import RowMapping

from app.store.clips.record import (
    AnalysisHints,
    AnalysisInput,
    AttachedAudio,
    ClipChanges,
    ClipLabels,
    ClipRecord,
    ClipState,
    ClipWarning,
    NewClip,
    Reanalysis,
)
from app.store.database.tables import clips

_LABELS = frozenset(field.name for field in fields(ClipLabels))
_HINT_COLUMNS = {field.name: f"{field.name}_override" for field in fields(AnalysisHints)}
_AUDIO_COLUMNS = {field.name: f"audio_{field.name}" for field in fields(AttachedAudio)}
_RECORD_COLUMNS = tuple(field.name for field in fields(ClipRecord) if field.name in clips.c)


def client_fields(new: NewClip) -> dict[str, Any]:
    """Labels, hints and recording of a new clip, by field name as in `ClipChanges`."""
    return {**_values(new.labels), **_values(new.hints), "audio": new.audio}


def to_columns(changes: ClipChanges) -> dict[str, Any]:
    """Column values for these changes, without the words, which have their own table.

    Raises KeyError for a name that is not a label, a hint or `audio`.
    """
    columns: dict[str, Any] = {}
    for name, value in changes.items():
        if name == "audio":
            columns |= _audio_columns(value)
        elif name not in _LABELS:
            columns[_HINT_COLUMNS[name]] = value
        elif name != "words":
            columns[name] = value
    if "name" in columns:
        columns["name_folded"] = columns["name"].casefold()
    return columns


def changed_input(before: ClipRecord, changes: ClipChanges) -> AnalysisInput:
    """The input of an analysis of the clip after the changes."""
    hints = {name: value for name, value in changes.items() if name in _HINT_COLUMNS}
    audio: AttachedAudio | None = changes.get("audio", before.audio)
    return replace(before.hints, **hints), None if audio is None else audio.sha256


def to_record(row: RowMapping, words: tuple[str, ...]) -> ClipRecord:
    """A row of `clips` and the clip's words as a record."""
    values: dict[str, Any] = {name: row[name] for name in _RECORD_COLUMNS}
    values |= {
        "words": words,
        "state": ClipState(row["state"]),
        "roles": dict(row["roles"] or {}),
        "missing_roles": tuple(row["missing_roles"] or ()),
        "warnings": tuple(ClipWarning(**warning) for warning in row["warnings"] or ()),
        "reanalysis": None if row["reanalysis"] is None else Reanalysis(row["reanalysis"]),
        "hints": _hints(row),
        "audio": _audio(row),
    }
    return ClipRecord(**values)


def _hints(row: RowMapping) -> AnalysisHints:
    return AnalysisHints(**{name: _frozen(row[column]) for name, column in _HINT_COLUMNS.items()})


def _audio(row: RowMapping) -> AttachedAudio | None:
    if row["audio_sha256"] is None:
        return None
    stored = {name: row[column] for name, column in _AUDIO_COLUMNS.items()}
    return AttachedAudio(**{name: value for name, value in stored.items() if value is not None})


def _frozen(value: Any) -> Any:
    # JSON has only lists, and a frozen dataclass holds tuples.
    return tuple(value) if isinstance(value, list) else value


def _audio_columns(audio: AttachedAudio | None) -> Mapping[str, Any]:
    return {
        column: None if audio is None else getattr(audio, name)
        for name, column in _AUDIO_COLUMNS.items()
    }


def _values(value: ClipLabels | AnalysisHints) -> dict[str, Any]:
    return {field.name: getattr(value, field.name) for field in fields(value)}
