"""Annotations of ELAN: files `.eaf` (EUDICO Annotation Format 3.0).

The tiers `words`, `person`, `text` and `by` hold what their names say. Annotations of different
tiers with the same start and end are one span. In any other tier, the values are words, and the
tier's participant is the person. An annotation that refers to another one (`REF_ANNOTATION`) has
the times of that one. Expat reads the file without a tree, opens no other files, and a file that
declares entities is refused.

Source: ELAN's schema EAFv3.0 (Max Planck Institute for Psycholinguistics).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from xml.parsers import expat
from xml.sax.saxutils import escape, quoteattr

from app.errors import TooLarge
from app.formats.annotations.span import MAX_FILE_BYTES, MAX_SPANS, Span
from app.formats.common.failures import unreadable_line
from app.kinedex_error import KinedexError

TIERS = ("words", "person", "text", "by")
MAX_DEPTH = 32
MAX_ITEMS = 10 * MAX_SPANS
"""Annotations of all tiers, and time slots."""
MAX_TEXT = 20_000
"""Characters of one annotation."""
MAX_REFERENCES = 100
"""Annotations that refer to each other in a row."""
_HEAD = """\
<?xml version="1.0" encoding="UTF-8"?>
<ANNOTATION_DOCUMENT AUTHOR="" DATE="1970-01-01T00:00:00+00:00" FORMAT="3.0" VERSION="3.0" \
xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" \
xsi:noNamespaceSchemaLocation="http://www.mpi.nl/tools/elan/EAFv3.0.xsd">
    <HEADER MEDIA_FILE="" TIME_UNITS="milliseconds"/>
"""
_TYPE = """\
    <LINGUISTIC_TYPE GRAPHIC_REFERENCES="false" LINGUISTIC_TYPE_ID="default" \
TIME_ALIGNABLE="true"/>
</ANNOTATION_DOCUMENT>
"""


def write_eaf(spans: Sequence[Span]) -> bytes:
    """An ELAN file with a tier for each of TIERS; times are rounded to milliseconds."""
    slots = "".join(
        f'        <TIME_SLOT TIME_SLOT_ID="ts{2 * number + end}" TIME_VALUE="{at}"/>\n'
        for number, span in enumerate(spans)
        for end, at in enumerate((_milliseconds(span.start), _milliseconds(span.end)), 1)
    )
    counter = iter(range(1, MAX_ITEMS))
    tiers = "".join(_tier(name, spans, counter) for name in TIERS)
    order = f"    <TIME_ORDER>\n{slots}    </TIME_ORDER>\n"
    return (_HEAD + order + tiers + _TYPE).encode()


def read_eaf(content: bytes) -> list[Span]:
    """The spans of an ELAN file, in order of time.

    Raises Unreadable with the line, and TooLarge beyond the limits.
    """
    if len(content) > MAX_FILE_BYTES:
        raise TooLarge(f"An ELAN file has at most {MAX_FILE_BYTES} bytes.")
    return list(_joined(_Reader().read(content)))


def _tier(name: str, spans: Sequence[Span], counter: Iterator[int]) -> str:
    lines = [f'    <TIER LINGUISTIC_TYPE_REF="default" TIER_ID={quoteattr(name)}>\n']
    for number, span in enumerate(spans):
        value = _value(name, span)
        if value is not None:
            lines.append(
                f'        <ANNOTATION>\n            <ALIGNABLE_ANNOTATION ANNOTATION_ID="a'
                f'{next(counter)}" TIME_SLOT_REF1="ts{2 * number + 1}" TIME_SLOT_REF2="ts'
                f'{2 * number + 2}">\n                <ANNOTATION_VALUE>{_escaped(value)}'
                "</ANNOTATION_VALUE>\n            </ALIGNABLE_ANNOTATION>\n"
                "        </ANNOTATION>\n"
            )
    return "".join([*lines, "    </TIER>\n"])


def _value(name: str, span: Span) -> str | None:
    """What a tier says about a span; None: nothing. A span without words has an empty one."""
    return " ".join(span.words) if name == "words" else getattr(span, name)


def _milliseconds(seconds: float) -> int:
    return round(seconds * 1000)


def _escaped(text: str) -> str:
    """The text as the content of an element; XML 1.0 has no other control characters."""
    return escape("".join(c for c in text if c >= " " or c in "\t\n"))


@dataclass(slots=True)
class _Item:
    """An annotation: its tier, its times by slots or by another annotation, and its value."""

    tier: int
    line: int
    slots: tuple[str, str] | None
    parent: str | None
    value: str = ""


@dataclass(slots=True)
class _Document:
    """slots: milliseconds by id; tiers: name and participant; items: annotations by id."""

    slots: dict[str, int | None] = field(default_factory=dict)
    tiers: list[tuple[str, str]] = field(default_factory=list)
    items: dict[str, _Item] = field(default_factory=dict)


class _Reader:
    """Handles the events of expat."""

    def __init__(self) -> None:
        self.found = _Document()
        self.depth = 0
        self.item: _Item | None = None
        self.text: list[str] | None = None
        self.length = 0
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.characters
        self.parser.EntityDeclHandler = self.refuse_entity

    def read(self, content: bytes) -> _Document:
        try:
            self.parser.Parse(content, True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            raise unreadable_line(error.lineno, f"expected XML, found {reason}") from None
        except (ValueError, LookupError) as error:  # an encoding that expat does not know
            raise self.unreadable(f"expected XML, found {error!s:.80}") from None
        if not self.found.tiers and not self.found.slots:
            raise self.unreadable("expected tiers of ELAN")
        return self.found

    def start(self, name: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.unreadable(f"expected at most {MAX_DEPTH} levels of elements")
        if self.depth == 1 and name != "ANNOTATION_DOCUMENT":
            raise self.unreadable(f"expected ANNOTATION_DOCUMENT, found {name!r:.80}")
        if name == "TIME_SLOT":
            self.add_slot(attributes)
        elif name == "TIER":
            label = attributes.get("TIER_ID", "")
            self.found.tiers.append((label, attributes.get("PARTICIPANT", "")))
        elif name in ("ALIGNABLE_ANNOTATION", "REF_ANNOTATION"):
            self.add_item(attributes)
        elif name == "ANNOTATION_VALUE":
            self.text, self.length = [], 0

    def add_slot(self, attributes: Mapping[str, str]) -> None:
        value = attributes.get("TIME_VALUE")
        if value is not None and not (value.isascii() and value.isdigit() and len(value) < 12):
            raise self.unreadable(f"expected milliseconds, found {value!r:.80}")
        self.limited(len(self.found.slots))
        name = attributes.get("TIME_SLOT_ID", "")
        self.found.slots[name] = None if value is None else int(value)

    def add_item(self, attributes: Mapping[str, str]) -> None:
        if not self.found.tiers:
            raise self.unreadable("expected annotations in a tier")
        self.limited(len(self.found.items))
        slots = attributes.get("TIME_SLOT_REF1"), attributes.get("TIME_SLOT_REF2")
        times = (slots[0], slots[1]) if slots[0] is not None and slots[1] is not None else None
        tier, line = len(self.found.tiers) - 1, self.parser.CurrentLineNumber
        self.item = _Item(tier, line, times, attributes.get("ANNOTATION_REF"))
        self.found.items[attributes.get("ANNOTATION_ID", f"line {line}")] = self.item

    def end(self, name: str) -> None:
        self.depth -= 1
        if name == "ANNOTATION_VALUE" and self.text is not None:
            if self.item is not None:
                self.item.value = "".join(self.text).strip()
            self.text = None

    def characters(self, text: str) -> None:
        if self.text is None:
            return
        self.length += len(text)
        if self.length > MAX_TEXT:
            raise self.unreadable(f"expected at most {MAX_TEXT} characters in an annotation")
        self.text.append(text)

    def refuse_entity(self, *_: object) -> None:
        raise self.unreadable("expected no entities")

    def limited(self, count: int) -> None:
        if count >= MAX_ITEMS:
            raise self.unreadable(f"expected at most {MAX_ITEMS} annotations")

    def unreadable(self, message: str) -> KinedexError:
        return unreadable_line(self.parser.CurrentLineNumber, message)


@dataclass(slots=True)
class _Growing:
    """A span to which the tiers add what they say."""

    start: int
    end: int
    line: int
    said: dict[str, str] = field(default_factory=dict)


def _joined(found: _Document) -> Iterator[Span]:
    """The spans of a file. Annotations with the same slots, or else the same times, are one."""
    by_slots: dict[tuple[str, str], _Growing] = {}
    by_times: dict[tuple[int, int], list[_Growing]] = {}
    for item in found.items.values():
        slots, (start, end) = _times(found, item)
        said = _said(*found.tiers[item.tier], item.value)
        same = [by_slots[slots]] if slots in by_slots else by_times.get((start, end), [])
        span = next((one for one in same if not one.said.keys() & said.keys()), None)
        if span is None:
            span = _Growing(start, end, item.line)
            by_times.setdefault((start, end), []).append(span)
        by_slots[slots] = span
        span.said |= said
    every = [span for some in by_times.values() for span in some]
    if len(every) > MAX_SPANS:
        raise TooLarge(f"An ELAN file has at most {MAX_SPANS} spans.")
    for span in sorted(every, key=lambda one: (one.start, one.end, one.line)):
        said = span.said
        yield Span(
            start=span.start / 1000,
            end=span.end / 1000,
            words=tuple(said.get("words", "").split()),
            person=said.get("person") or None,
            text=said.get("text") or None,
            by=said.get("by") or None,
            place=f"line {span.line}",
        )


def _said(tier: str, participant: str, value: str) -> dict[str, str]:
    """What an annotation says, by the names of TIERS."""
    name = tier.strip().lower()
    found = {name if name in TIERS else "words": value}
    return found | ({"person": participant} if participant and name != "person" else {})


def _times(found: _Document, item: _Item) -> tuple[tuple[str, str], tuple[int, int]]:
    """The slots and the milliseconds of an annotation, or of the one that it refers to."""
    first = item
    for _ in range(MAX_REFERENCES):
        if item.slots is not None:
            break
        parent = found.items.get(item.parent or "")
        if parent is None:
            raise unreadable_line(first.line, f"{item.parent!r:.80} is no annotation")
        item = parent
    if item.slots is None:
        raise unreadable_line(first.line, "annotations refer to each other in a circle")
    return item.slots, (_at(found, item, 0), _at(found, item, 1))


def _at(found: _Document, item: _Item, end: int) -> int:
    slot = (item.slots or ("", ""))[end]
    if slot not in found.slots:
        raise unreadable_line(item.line, f"{slot!r:.80} is no time slot")
    at = found.slots[slot]
    if at is None:
        raise unreadable_line(item.line, f"the time slot {slot!r:.80} has no time")
    return at
