"""Evaluations: how well the methods do on the library's own labels."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from app.api.schemas.base import Cursor, Incoming, Label, Limit, Outgoing, Paged
from app.api.schemas.filters import Filter
from app.services.evaluations.options import (
    LABELS,
    MAX_K,
    MAX_LIST,
    MAX_QUERIES,
    METHODS,
    EvaluationKind,
    EvaluationOptions,
)
from app.store.evaluations import EvaluationRecord

_Names = Annotated[list[Label], Field(min_length=1, max_length=MAX_LIST)]
_METHOD_NAMES = "; ".join(f"{kind.value}: {', '.join(names)}" for kind, names in METHODS.items())


class NewEvaluation(Incoming):
    """What to judge. Every kind has a `filter`; the other options say which kinds have them."""

    kind: EvaluationKind = Field(
        description="recognition: persons and tasks of clips that were held out. retrieval: search"
        " by example, with each labeled clip as the query. words: words for clips, and clips for"
        " words. keyposes: found keyposes against those that people named. low-dimensional: motions"
        " reduced to few dimensions. symbols: the motion symbol space. The last two need no labels."
    )
    filter: Filter | None = Field(None, description="The clips to judge. Default: all.")
    by: Label | None = Field(
        None,
        description="recognition, retrieval, keyposes: figures for each group of clips too. "
        f"`meta.KEY`, or one of {', '.join(LABELS)}.",
    )
    methods: _Names | None = Field(
        None, description=f"The methods to judge; default: all. Of {_METHOD_NAMES}."
    )
    false_accept_rate: float | None = Field(
        None,
        gt=0,
        lt=1,
        description="recognition: how often new persons and tasks may be called known.",
    )
    classes: _Names | None = Field(
        None, description="retrieval: the tasks of Sun's table 1. Default: the four largest."
    )
    k: int | None = Field(
        None, ge=1, le=MAX_K, description="retrieval: nearest clips to judge. Default: 20."
    )
    eta: float | None = Field(
        None,
        ge=0,
        le=10,
        description="retrieval: judge the MSV methods with this threshold too, in body lengths.",
    )
    max_queries: int | None = Field(
        None,
        ge=1,
        le=MAX_QUERIES,
        description="retrieval: largest number of query clips, evenly from the tasks. Default: "
        "1000.",
    )
    queries: _Names | None = Field(
        None,
        description="words: words of the examples, as `high kick`. Default: the most frequent.",
    )
    tolerance: float | None = Field(
        None,
        gt=0,
        le=1,
        description="keyposes: seconds between a found keypose and the true one, at most.",
    )

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"kind": "symbols"},
                {"kind": "recognition", "methods": ["default", "prior"], "by": "task"},
            ]
        }
    )

    def options(self) -> EvaluationOptions:
        """The options as the service takes them."""
        sent = {name: getattr(self, name) for name in type(self).model_fields if name != "kind"}
        values: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in sent.items()
        }
        values["filter"] = self.filter.given() or None if self.filter else None
        return EvaluationOptions(**values)


class EvaluationFigure(Outgoing):
    """One of the main figures of an evaluation."""

    name: str
    value: float
    unit: Literal["share", "mm", "number"] = Field(description="share: 0..1. mm: millimeters.")


class EvaluationSummary(Outgoing):
    """A kept evaluation. It never changes: it says how the library was when it was judged."""

    id: str
    kind: EvaluationKind
    options: dict[str, Any] = Field(description="The options that were set, by name.")
    library_version: int = Field(description="The library's version at the start.")
    library_size: int = Field(
        description="Number of ready clips that passed the filter at the start, without synthesized"
        " clips."
    )
    seconds: float = Field(ge=0, description="How long it took.")
    figures: list[EvaluationFigure] = Field(
        description="The main figures. Evaluations of one kind can be compared by their names."
    )
    created_at: datetime = Field(description="When it had ended.")


class Evaluation(EvaluationSummary):
    """A kept evaluation with all its results."""

    document: dict[str, Any] = Field(
        description="All results: what `kinedex evaluate KIND --json` prints. Its members depend on"
        " the kind. If it would have over 4 MB, its largest members are left out, and `trimmed`"
        " names them."
    )
    previous: EvaluationSummary | None = Field(
        description="The evaluation of the same kind before it, to compare the figures; null for"
        " the first."
    )

    @classmethod
    def of(
        cls,
        record: EvaluationRecord,
        document: Mapping[str, Any],
        previous: EvaluationRecord | None,
    ) -> Evaluation:
        """The evaluation as the API shows it."""
        shown = EvaluationSummary.model_validate(record)
        before = None if previous is None else EvaluationSummary.model_validate(previous)
        members = {name: getattr(shown, name) for name in EvaluationSummary.model_fields}
        return cls(**members, document=dict(document), previous=before)


class EvaluationList(Paged):
    """A page of kept evaluations, the newest first, without their documents."""

    items: list[EvaluationSummary]


class EvaluationQuery(Incoming):
    """A filter of the list of evaluations, and a page of it."""

    kind: EvaluationKind | None = None
    limit: Limit = 20
    cursor: Cursor | None = None
