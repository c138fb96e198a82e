"""The kinds of evaluations, and the options of each kind with their checks.

The options are those of the commands `kinedex evaluate ...`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from dataclasses import fields as members
from enum import StrEnum
from typing import Any, Self

from app.errors import BadField
from app.kinedex_error import Place
from app.search.example.methods import Method
from app.search.index.filters import parse_filter
from app.services import fields
from app.store.clips.record import META


class EvaluationKind(StrEnum):
    """What an evaluation measures, named as the commands."""

    RECOGNITION = "recognition"
    """Persons and tasks of held-out clips (Vasilescu 2002; Perera 2009)."""
    RETRIEVAL = "retrieval"
    """Search by example: are the nearest clips of the same task? (Sun 2011)"""
    WORDS = "words"
    """Words for clips, and clips for words (Takano)."""
    KEYPOSES = "keyposes"
    """Found keyposes against those that people named (Perera 2009)."""
    LOW_DIMENSIONAL = "low-dimensional"
    """Errors of motions that were reduced to few dimensions (Perera 2009)."""
    SYMBOLS = "symbols"
    """Errors of the motion symbol space (Takano)."""


RECOGNIZERS = ("default", "multilinear", "signatures", "pca", "perera", "mean-motion", "prior")
"""The methods of an evaluation of recognition: those of `app.evaluate`, which is slow to import."""
LABELS = ("person", "task", "license", "source", "folder", "format")
"""The labels that clips can be grouped by, besides the metadata."""
MAX_K = 1000
MAX_QUERIES = 10_000
MAX_TOLERANCE = 1.0
MAX_LIST = 100
"""Largest number of methods, classes or queries."""


@dataclass(frozen=True, slots=True)
class EvaluationOptions:
    """The options of an evaluation; None: the default of its command.

    filter: the clips to judge; by: figures for each group of clips, a label of LABELS or
    `meta.KEY`; methods: the methods to judge; false_accept_rate: 0..1, how often new persons and
    tasks may be called known; classes: the tasks of Sun's table 1; k: nearest clips to judge; eta:
    a threshold of Sun's methods in body lengths; max_queries: largest number of query clips;
    queries: words of the examples of Takano's table 2; tolerance: seconds between a found keypose
    and the true one.
    """

    filter: Mapping[str, Any] | None = None
    by: str | None = None
    methods: tuple[str, ...] | None = None
    false_accept_rate: float | None = None
    classes: tuple[str, ...] | None = None
    k: int | None = None
    eta: float | None = None
    max_queries: int | None = None
    queries: tuple[str, ...] | None = None
    tolerance: float | None = None

    def to_json(self) -> dict[str, Any]:
        """The options that are set, as JSON."""
        given = {name: value for name, value in asdict(self).items() if value is not None}
        return {name: list(v) if isinstance(v, tuple) else v for name, v in given.items()}

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """The options that `to_json` wrote."""
        values: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in document.items()
        }
        return cls(**values)


def check(kind: EvaluationKind, options: EvaluationOptions) -> None:
    """Raise BadField for options that this kind does not have, and for wrong values."""
    known = OPTIONS[kind]
    given = [one.name for one in members(options) if getattr(options, one.name) is not None]
    places = [
        Place(name, f"is no option of {kind.value}; its options are {', '.join(known)}")
        for name in given
        if name not in known
    ]
    if places:
        raise BadField("The evaluation has options that it does not know.", places=places)
    parse_filter(options.filter)
    for name in given:
        if name in _CHECKS:
            _CHECKS[name](kind, getattr(options, name))


OPTIONS: Mapping[EvaluationKind, tuple[str, ...]] = {
    EvaluationKind.RECOGNITION: ("filter", "by", "methods", "false_accept_rate"),
    EvaluationKind.RETRIEVAL: ("filter", "by", "methods", "classes", "k", "eta", "max_queries"),
    EvaluationKind.WORDS: ("filter", "queries"),
    EvaluationKind.KEYPOSES: ("filter", "by", "tolerance"),
    EvaluationKind.LOW_DIMENSIONAL: ("filter",),
    EvaluationKind.SYMBOLS: ("filter",),
}
"""The options of each kind."""


def _check_by(_: EvaluationKind, by: str) -> None:
    if by not in LABELS and not by.startswith(META):
        raise fields.bad_field("by", f"must be {META}KEY or one of {', '.join(LABELS)}")


def _check_methods(kind: EvaluationKind, methods: tuple[str, ...]) -> None:
    known = METHODS[kind]
    unknown = [method for method in methods if method not in known]
    if unknown or not methods:
        said = f"not {', '.join(unknown)}" if unknown else "not none"
        raise fields.bad_field("methods", f"must be of {', '.join(known)}, {said}")


METHODS: Mapping[EvaluationKind, tuple[str, ...]] = {
    EvaluationKind.RECOGNITION: RECOGNIZERS,
    EvaluationKind.RETRIEVAL: tuple(method.value for method in Method),
}
"""The methods that a kind can judge."""


def _between(
    name: str, least: float, most: float, *, excluded: bool = False
) -> Callable[[EvaluationKind, float], None]:
    """A check that a number is within both bounds; excluded: the lower one is not allowed."""

    def check_number(_: EvaluationKind, value: float) -> None:
        is_low = value <= least if excluded else value < least
        if not math.isfinite(value) or is_low or value > most:
            begin = f"above {least:g}" if excluded else f"at least {least:g}"
            raise fields.bad_field(name, f"must be {begin} and at most {most:g}, not {value:g}")

    return check_number


_CHECKS: Mapping[str, Callable[[EvaluationKind, Any], None]] = {
    "by": _check_by,
    "methods": _check_methods,
    "false_accept_rate": _between("false_accept_rate", 0, 1, excluded=True),
    "k": _between("k", 1, MAX_K),
    "eta": _between("eta", 0, 10),
    "max_queries": _between("max_queries", 1, MAX_QUERIES),
    "tolerance": _between("tolerance", 0, MAX_TOLERANCE, excluded=True),
}
