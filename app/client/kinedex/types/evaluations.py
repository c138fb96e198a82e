"""Answers: evaluations. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

from kinedex.records import Page, Record
from kinedex.types.choices import EvaluationKind


@dataclass(frozen=True, slots=True)
class EvaluationFigure(Record):
    """One of the main figures of an evaluation.

    unit: share: 0..1. mm: millimeters.
    """

    name: str
    value: float
    unit: Literal["share", "mm", "number"]


@dataclass(frozen=True, slots=True)
class EvaluationSummary(Record):
    """A kept evaluation. It never changes: it says how the library was when it was judged.

    options: The options that were set, by name.
    library_version: The library's version at the start.
    library_size: Number of ready clips that passed the filter at the start, without synthesized
    clips.
    seconds: How long it took.
    figures: The main figures. Evaluations of one kind can be compared by their names.
    created_at: When it had ended.
    """

    id: str
    kind: EvaluationKind
    options: dict[str, Any]
    library_version: int
    library_size: int
    seconds: float
    figures: list[EvaluationFigure]
    created_at: datetime


@dataclass(frozen=True, slots=True)
class Evaluation(Record):
    """A kept evaluation with all its results.

    options: The options that were set, by name.
    library_version: The library's version at the start.
    library_size: Number of ready clips that passed the filter at the start, without synthesized
    clips.
    seconds: How long it took.
    figures: The main figures. Evaluations of one kind can be compared by their names.
    created_at: When it had ended.
    document: All results: what `kinedex evaluate KIND --json` prints. Its members depend on the
    kind. If it would have over 4 MB, its largest members are left out, and `trimmed` names
    them.
    previous: The evaluation of the same kind before it, to compare the figures; null for the
    first.
    """

    id: str
    kind: EvaluationKind
    options: dict[str, Any]
    library_version: int
    library_size: int
    seconds: float
    figures: list[EvaluationFigure]
    created_at: datetime
    document: dict[str, Any]
    previous: EvaluationSummary | None


@dataclass(frozen=True, slots=True)
class EvaluationList(Page[EvaluationSummary]):
    """A page of kept evaluations, the newest first, without their documents.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[EvaluationSummary]
