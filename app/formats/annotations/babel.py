"""Annotations of BABEL: JSON with labels of whole sequences and of their parts.

A sequence is an object with `frame_ann` (labels with `start_t` and `end_t`, seconds) and `seq_ann`
(labels of the whole). The data set's files hold many sequences by their number, each with its path
`feat_p`. Words are the categories `act_cat`, or else the processed label; the text is the raw
label. The labels of the whole count only if there are none of parts, as in the data set's own
split of dense and sparse labels.

Source: Punnakkal et al., *BABEL: Bodies, Action and Behavior with English Labels*, 2021.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.errors import TooLarge, Unreadable
from app.formats.annotations.span import MAX_FILE_BYTES, MAX_SPANS, Span, as_phrase
from app.kinedex_error import Place

MAX_SEQUENCES = 100_000
MAX_TIME = 1e9
"""Seconds. NaN and infinity are no times either."""
_PARTS, _WHOLE = ("frame_ann", "frame_anns"), ("seq_ann", "seq_anns")


@dataclass(frozen=True, slots=True)
class LabeledSequence:
    """A sequence of a BABEL file. path: of its motion in AMASS, None if the file has none."""

    path: str | None
    spans: tuple[Span, ...]


def write_babel(spans: Sequence[Span], seconds: float | None) -> bytes:
    """A BABEL file of one sequence that is `seconds` long."""
    labels = [
        {
            "raw_label": span.text or " ".join(span.words),
            "proc_label": " ".join(word.replace("_", " ") for word in span.words),
            "act_cat": [word.replace("_", " ") for word in span.words],
            "start_t": span.start,
            "end_t": span.end,
            "person": span.person,
            "by": span.by,
            "has_text": span.text is not None,
        }
        for span in spans
    ]
    document = {"dur": seconds, "seq_ann": None, "frame_ann": {"labels": labels}}
    return json.dumps(document, ensure_ascii=False, indent=1).encode()


def read_babel(content: bytes, seconds: float | None = None) -> list[LabeledSequence]:
    """The sequences of a BABEL file.

    seconds: the length of the motion, for labels of the whole in a file that does not say it.
    Raises Unreadable with the place, and TooLarge beyond the limits.
    """
    if len(content) > MAX_FILE_BYTES * 8:
        raise TooLarge(f"A BABEL file has at most {MAX_FILE_BYTES * 8} bytes.")
    try:
        document = json.loads(content)
    except (ValueError, RecursionError) as problem:
        raise _unreadable("the file", "expected JSON") from problem
    if _is_sequence(document):
        return [_sequence(document, "", seconds)]
    if not isinstance(document, dict) or not all(map(_is_sequence, document.values())):
        raise _unreadable("the file", "expected `seq_ann` or `frame_ann`")
    if len(document) > MAX_SEQUENCES:
        raise TooLarge(f"A BABEL file has at most {MAX_SEQUENCES} sequences.")
    return [_sequence(one, f"{name}.", None) for name, one in document.items()]


def _is_sequence(value: object) -> bool:
    return isinstance(value, dict) and bool({*_PARTS, *_WHOLE} & value.keys())


def _sequence(document: Mapping[str, Any], where: str, seconds: float | None) -> LabeledSequence:
    given = document.get("dur")
    length = _number(given, f"{where}dur") if given is not None else seconds
    parts = list(_labels(document, _PARTS, where))
    spans = [_span(label, place, None) for place, label in parts]
    if not spans and length is not None:
        whole = _labels(document, _WHOLE, where)
        spans = [_span(label, place, length) for place, label in whole]
    if len(spans) > MAX_SPANS:
        raise TooLarge(f"A sequence has at most {MAX_SPANS} labels.")
    path = document.get("feat_p")
    return LabeledSequence(path if isinstance(path, str) else None, tuple(spans))


def _labels(
    document: Mapping[str, Any], names: Sequence[str], where: str
) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """The labels of an annotation or of several, with their places."""
    for name in names:
        found = document.get(name)
        for one in found if isinstance(found, list) else [found]:
            labels = one.get("labels") if isinstance(one, dict) else None
            if labels is None:
                continue
            if not isinstance(labels, list):
                raise _unreadable(f"{where}{name}.labels", "expected a list")
            for number, label in enumerate(labels):
                place = f"{where}{name}.labels.{number}"
                if not isinstance(label, dict):
                    raise _unreadable(place, "expected an object")
                yield place, label


def _span(label: Mapping[str, Any], place: str, length: float | None) -> Span:
    start = 0.0 if length is not None else _number(label.get("start_t"), f"{place}.start_t")
    end = length if length is not None else _number(label.get("end_t"), f"{place}.end_t")
    categories = label.get("act_cat")
    given = categories if isinstance(categories, list) else []
    named = [one for one in given if isinstance(one, str)]
    processed = _text(label, "proc_label")
    raw = _text(label, "raw_label") if label.get("has_text", True) else None
    words = tuple(map(as_phrase, named)) or tuple((processed or "").split())
    return Span(start, end, words, _text(label, "person"), raw, _text(label, "by"), place)


def _text(label: Mapping[str, Any], name: str) -> str | None:
    value = label.get(name)
    return value.strip() or None if isinstance(value, str) else None


def _number(value: object, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < MAX_TIME:
        raise _unreadable(place, "expected seconds")
    return float(value)


def _unreadable(place: str, message: str) -> Unreadable:
    return Unreadable(
        f"The BABEL file cannot be read: {place}: {message}.", places=[Place(place, message)]
    )
