"""Files of annotations come back as they were written, and broken ones are refused with a place."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import TooLarge, Unreadable
from app.formats.annotations import babel, eaf, table
from app.formats.annotations.span import Span

# Texts as the service stores them: no control characters, no spaces at the ends.
TEXTS = st.text(
    st.characters(
        codec="utf-8", exclude_categories=["Cc", "Cs"], exclude_characters="\ufffe\uffff"
    ),
    min_size=1,
    max_size=20,
).map(lambda text: " ".join(text.split()))
MAYBE = st.none() | TEXTS.filter(bool)
WORDS = st.lists(st.from_regex(r"[a-zäß]{1,8}(_[a-z]{1,5})?", fullmatch=True), max_size=4)


@st.composite
def spans(draw: st.DrawFn) -> list[Span]:
    found = []
    for _ in range(draw(st.integers(0, 6))):
        start = draw(st.integers(0, 100_000))
        end = start + draw(st.integers(1, 50_000))
        words, person = tuple(draw(WORDS)), draw(MAYBE)
        found.append(Span(start / 1000, end / 1000, words, person, draw(MAYBE), draw(MAYBE)))
    return sorted(found, key=lambda span: (span.start, span.end))


def without_place(found: list[Span]) -> list[Span]:
    return [replace(span, place="") for span in found]


@given(spans())
def test_elan_files_come_back(written: list[Span]) -> None:
    read = without_place(eaf.read_eaf(eaf.write_eaf(written)))
    assert sorted(read, key=repr) == sorted(written, key=repr)


@given(spans())
def test_tables_come_back(written: list[Span]) -> None:
    rows = table.read_table(table.write_table(("walk.bvh", span) for span in written))
    assert [clip for clip, _ in rows] == ["walk.bvh"] * len(written)
    assert without_place([span for _, span in rows]) == written


@given(spans())
def test_babel_files_come_back(written: list[Span]) -> None:
    worded = [replace(span, words=span.words or ("walk",)) for span in written]
    (sequence,) = babel.read_babel(babel.write_babel(worded, 200.0))
    assert without_place(list(sequence.spans)) == worded


@given(st.binary(max_size=300), st.sampled_from((eaf.read_eaf, table.read_table, babel.read_babel)))
def test_any_bytes_are_read_or_refused(content: bytes, read: object) -> None:
    with suppress(Unreadable, TooLarge):
        read(content)  # type: ignore[operator]


@given(spans().filter(bool), st.data())
def test_cut_and_changed_files_are_read_or_refused(
    written: list[Span], data: st.DataObject
) -> None:
    read, content = data.draw(
        st.sampled_from(
            (
                (eaf.read_eaf, eaf.write_eaf(written)),
                (table.read_table, table.write_table(("a", span) for span in written)),
                (babel.read_babel, babel.write_babel(written, 9.0)),
            )
        )
    )
    at = data.draw(st.integers(0, len(content) - 1))
    changed = data.draw(st.sampled_from((content[:at], content[:at] + b"\xff" + content[at + 1 :])))
    with suppress(Unreadable, TooLarge):
        read(changed)


def test_tiers_of_others_are_words_of_their_participant() -> None:
    content = b"""<?xml version="1.0"?>
<ANNOTATION_DOCUMENT><TIME_ORDER>
<TIME_SLOT TIME_SLOT_ID="a" TIME_VALUE="500"/><TIME_SLOT TIME_SLOT_ID="b" TIME_VALUE="1500"/>
<TIME_SLOT TIME_SLOT_ID="c" TIME_VALUE="500"/><TIME_SLOT TIME_SLOT_ID="d" TIME_VALUE="1500"/>
</TIME_ORDER>
<TIER TIER_ID="gesture" PARTICIPANT="Anna"><ANNOTATION>
<ALIGNABLE_ANNOTATION ANNOTATION_ID="1" TIME_SLOT_REF1="a" TIME_SLOT_REF2="b">
<ANNOTATION_VALUE>wave left_hand</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION></TIER>
<TIER TIER_ID="Text"><ANNOTATION>
<REF_ANNOTATION ANNOTATION_ID="2" ANNOTATION_REF="1">
<ANNOTATION_VALUE>she says &quot;hi&quot;</ANNOTATION_VALUE></REF_ANNOTATION></ANNOTATION></TIER>
<TIER TIER_ID="by"><ANNOTATION>
<ALIGNABLE_ANNOTATION ANNOTATION_ID="3" TIME_SLOT_REF1="c" TIME_SLOT_REF2="d">
<ANNOTATION_VALUE>me</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></ANNOTATION></TIER>
</ANNOTATION_DOCUMENT>"""
    (found,) = eaf.read_eaf(content)
    assert found.place == "line 7"
    expected = Span(0.5, 1.5, ("wave", "left_hand"), "Anna", 'she says "hi"', "me")
    assert replace(found, place="") == expected


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("<TIER TIER_ID='a'><ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID='1' "
         "TIME_SLOT_REF1='x' TIME_SLOT_REF2='y'/></ANNOTATION></TIER>", "'x' is no time slot"),
        ("<TIER TIER_ID='a'><ANNOTATION><REF_ANNOTATION ANNOTATION_ID='1' ANNOTATION_REF='1'/>"
         "</ANNOTATION></TIER>", "in a circle"),
        ("<TIME_ORDER><TIME_SLOT TIME_SLOT_ID='x' TIME_VALUE='-5'/></TIME_ORDER>", "milliseconds"),
        ("", "tiers"),
    ],
)  # fmt: skip
def test_broken_elan_files_name_the_line(inside: str, message: str) -> None:
    with pytest.raises(Unreadable, match=message):
        eaf.read_eaf(f"<ANNOTATION_DOCUMENT>{inside}</ANNOTATION_DOCUMENT>".encode())


def test_entities_are_refused() -> None:
    bomb = b'<!DOCTYPE a [<!ENTITY x "y">]><ANNOTATION_DOCUMENT>&x;</ANNOTATION_DOCUMENT>'
    with pytest.raises(Unreadable, match="no entities"):
        eaf.read_eaf(bomb)


def test_a_table_of_a_spreadsheet_with_semicolons_and_decimal_commas() -> None:
    ((clip, span),) = table.read_table(b"\xef\xbb\xbfstart;end;words\r\n0,5;1,25;kick left\r\n")
    assert (clip, span.start, span.end, span.words) == ("", 0.5, 1.25, ("kick", "left"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "name the columns"),
        (b"start,words\n", "end is missing"),
        (b"start,end,wrods\n", "'wrods' is no column"),
        (b"start,end\n0,never\n", "line 2: end must be seconds"),
        (b"start,end\n0,1\n0,nan\n", "line 3"),
        (b"start,end\n0,\xff\n", "line 2: not UTF-8"),
    ],
)
def test_broken_tables_name_the_line(content: bytes, message: str) -> None:
    with pytest.raises(Unreadable, match=message):
        table.read_table(content)


def test_labels_of_the_whole_count_only_without_labels_of_parts() -> None:
    whole = {"labels": [{"raw_label": "walks around", "act_cat": ["walk", "turn around"]}]}
    parts = {"labels": [{"proc_label": "walk", "start_t": 1, "end_t": 2.5}]}
    both = {
        "8": {"feat_p": "KIT/3/a.npz", "dur": 4.0, "seq_ann": whole, "frame_ann": None},
        "9": {"feat_p": "KIT/3/b.npz", "dur": 4.0, "seq_ann": whole, "frame_ann": parts},
    }
    first, second = babel.read_babel(json.dumps(both).encode())
    assert (first.path, second.path) == ("KIT/3/a.npz", "KIT/3/b.npz")
    assert without_place(list(first.spans)) == [
        Span(0.0, 4.0, ("walk", "turn_around"), text="walks around")
    ]
    assert without_place(list(second.spans)) == [Span(1.0, 2.5, ("walk",))]
    # A file without a length: the length of the motion counts.
    (alone,) = babel.read_babel(json.dumps({"seq_ann": whole}).encode(), 3.0)
    assert alone.spans[0].end == 3.0


def test_a_broken_babel_file_names_the_label() -> None:
    broken = {"frame_ann": {"labels": [{"start_t": 0, "end_t": "soon"}]}}
    with pytest.raises(Unreadable) as refused:
        babel.read_babel(json.dumps(broken).encode())
    assert refused.value.places[0].location == "frame_ann.labels.0.end_t"
