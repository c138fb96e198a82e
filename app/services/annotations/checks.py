"""The checks of what clients and files say about a part of a clip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from app.errors import BadField
from app.formats.annotations.span import DECIMALS, MAX_SPANS, Span
from app.kinedex_error import Place
from app.services import fields
from app.store.clips.clip_annotations import NewAnnotation, Origin

MAX_ANNOTATIONS = MAX_SPANS
"""Annotations of one clip: three hours with one a second."""
MAX_SECONDS = 1e6
TOLERANCE = 0.05
"""Seconds that an annotation may end after its clip, since tools round and count frames
differently. It is cut there."""

CHANGEABLE = ("start", "end", "words", "person", "text", "by")
"""What clients say about a part of a clip."""


def checked(
    values: Mapping[str, Any], seconds: float | None, where: str = "", origin: Origin | None = None
) -> NewAnnotation:
    """An annotation in its normal form, from values by the names of CHANGEABLE.

    seconds: the length of the clip, None before its analysis. where: comes before the names of
    fields in errors. Raises BadField with the field.
    """
    try:
        start = _time("start", values.get("start"))
        end = _time("end", values.get("end"))
        if seconds is not None and end > seconds + TOLERANCE:
            message = f"{end:g} s is after the clip's end at {seconds:.3f} s"
            raise fields.bad_field("end", message)
        end = end if seconds is None else min(end, round(seconds, DECIMALS))
        if start >= end:
            raise fields.bad_field("start", f"{start:g} s must be before the end at {end:g} s")
        found = NewAnnotation(
            start=start,
            end=end,
            words=fields.words(values.get("words")) or (),
            person=fields.text("person", values.get("person")),
            text=fields.text("text", values.get("text")),
            by=fields.text("by", values.get("by")),
            origin=origin or Origin(values.get("origin", Origin.PERSON)),
            probability=values.get("probability"),
        )
        if not (found.words or found.person or found.text):
            raise fields.bad_field("words", "words, a person or a text are needed")
    except BadField as problem:
        raise _placed(problem, where) from problem
    return found


def checked_all(
    values: Sequence[Mapping[str, Any]], seconds: float | None, origin: Origin | None = None
) -> tuple[NewAnnotation, ...]:
    """All annotations of a clip, by start. Raises BadField as `items.3.end`."""
    if len(values) > MAX_ANNOTATIONS:
        raise fields.bad_field("items", f"must not be more than {MAX_ANNOTATIONS}")
    found = [checked(one, seconds, f"items.{number}.", origin) for number, one in enumerate(values)]
    return in_order(found)


def of_spans(spans: Sequence[Span], seconds: float | None) -> tuple[NewAnnotation, ...]:
    """The annotations of a file. Raises BadField with the place in the file."""
    if len(spans) > MAX_ANNOTATIONS:
        raise fields.bad_field("file", f"must not hold more than {MAX_ANNOTATIONS} annotations")
    found = [
        checked(
            {name: getattr(span, name) for name in CHANGEABLE},
            seconds,
            f"{span.place}: ",
            Origin.IMPORT,
        )
        for span in spans
        if span.words or span.person or span.text
    ]
    return in_order(found)


def in_order(found: Sequence[NewAnnotation]) -> tuple[NewAnnotation, ...]:
    """Annotations by start, without repetitions."""
    return tuple(dict.fromkeys(sorted(found, key=lambda one: (one.start, one.end))))


def _time(name: str, value: Any) -> float:
    number = fields.parsed_number(name, value)
    if number is None or not 0 <= number <= MAX_SECONDS:
        raise fields.bad_field(name, f"must be seconds from 0 to {MAX_SECONDS:g}")
    return round(number, DECIMALS)


def _placed(problem: BadField, where: str) -> BadField:
    places = [Place(f"{where}{one.location}", one.message) for one in problem.places]
    return BadField(f"{where}{problem.detail}", places=places)
