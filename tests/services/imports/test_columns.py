"""The names of a manifest's columns: fields, metadata, and typing errors."""

from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import Unreadable
from app.services.imports.columns import BadColumn, Columns, nearest, typing_errors
from app.services.imports.manifest import COLUMNS, Manifest
from app.services.imports.manifest_table import ManifestLimits

WORDS = st.text(alphabet="tasky_", max_size=7)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("tsak", "task"),
        ("Persn", "person"),
        ("licence", "license"),
        ("Frame Rate", "frame_rate"),
        ("frame-rate", "frame_rate"),
        ("keypsoes", "keyposes"),
        ("word", "words"),
    ],
)
def test_a_near_miss_is_an_error_that_names_the_field(written: str, meant: str) -> None:
    with pytest.raises(Unreadable, match=f"`{written}`.*is `{meant}` meant") as refused:
        Manifest(ManifestLimits(5)).read(io.BytesIO(f"path,{written}\na.bvh,x\n".encode()))
    assert refused.value.places[0].location == "manifest.csv line 1"


@pytest.mark.parametrize("name", ["take", "condition", "trial", "age", "fpv", "mass", "Subject No"])
def test_other_names_are_metadata(name: str) -> None:
    columns = Columns(["path", name], COLUMNS)
    assert columns.keys == (name,)
    assert columns.metadata_cells(["a.bvh", " x "]) == ("x",)


def test_a_name_with_meta_before_it_is_metadata_in_any_case() -> None:
    assert Columns(["path", "meta.tsak"], COLUMNS).keys == ("tsak",)


@pytest.mark.parametrize(
    ("header", "part"),
    [
        (["path", "task", "Task"], "two columns are called `task`"),
        (["path", "mood", "meta.mood"], "two columns are called `mood`"),
        (["path", "a.b"], "must not hold"),
        (["path", "meta.person"], "name of a field"),
        (["path", "x" * 61], "characters"),
    ],
)
def test_a_column_that_cannot_be_used_is_named(header: list[str], part: str) -> None:
    with pytest.raises(BadColumn, match=part):
        Columns(header, COLUMNS)


def test_empty_headings_are_ignored() -> None:
    assert Columns(["path", "", "", "task"], COLUMNS).names == ("task",)


@given(WORDS, WORDS)
def test_typing_errors_are_a_distance(first: str, second: str) -> None:
    errors = typing_errors(first, second)
    assert errors == typing_errors(second, first)
    assert (errors == 0) == (first == second)
    assert abs(len(first) - len(second)) <= errors <= max(len(first), len(second))


@given(WORDS, st.integers(0, 6), st.sampled_from("xyz"))
def test_one_change_is_at_most_one_error(word: str, at: int, letter: str) -> None:
    changed = [
        word[:at] + letter + word[at:],
        word[:at] + word[at + 1 :],
        word[:at] + letter + word[at + 1 :],
        word[:at] + word[at + 1 : at + 2] + word[at : at + 1] + word[at + 2 :],
    ]
    assert max(typing_errors(word, other) for other in changed) <= 1


def test_a_field_is_near_to_itself() -> None:
    assert [nearest(name, COLUMNS) for name in ("task", "tasks")] == ["task", "task"]
