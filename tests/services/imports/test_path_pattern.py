"""Labels from paths."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import BadField
from app.services.imports.path_pattern import PathPattern

PARTS = st.text(alphabet="abc01 -", min_size=1, max_size=5).filter(
    lambda part: part.strip() == part
)


@pytest.mark.parametrize(
    ("pattern", "path", "values"),
    [
        (
            "{person}/{task}/{take}.bvh",
            "anna/walk/01.bvh",
            {"person": "anna", "task": "walk", "metadata": {"take": "01"}},
        ),
        ("{person}/{task}/{take}.bvh", "lab/anna/walk/01.bvh", None),
        (
            "**/{person}/*/{take}.bvh",
            "lab/anna/walk/7.bvh",
            {"person": "anna", "metadata": {"take": 7}},
        ),
        ("**/{person}/*", "anna/walk.c3d", {"person": "anna"}),
        ("{person}_{task}", "anna_walk.c3d", {"person": "anna", "task": "walk"}),
        ("{person}_{task}.bvh", "anna_walk.c3d", None),
        ("./{source}/**", "cmu/02/02_01.bvh", {"source": "cmu"}),
        ("{frame_rate}fps/*", "60fps/a.bvh", {"frame_rate": "60"}),
        ("a+b/{task}.bvh", "a+b/walk.bvh", {"task": "walk"}),
    ],
)
def test_a_pattern_gives_labels_and_metadata(
    pattern: str, path: str, values: dict[str, Any] | None
) -> None:
    assert PathPattern(pattern).values(path) == values


@pytest.mark.parametrize(
    ("pattern", "part"),
    [
        ("{tsak}/*", "is `task` meant"),
        ("{person}/{person}.bvh", "twice"),
        ("walk.bvh", "names in braces"),
        ("{person/x", "names in braces"),
        ("{}/x", "characters"),
        ("{a.b}", "must not hold"),
        ("x" * 501, "longer"),
    ],
)
def test_a_bad_pattern_is_refused(pattern: str, part: str) -> None:
    with pytest.raises(BadField, match=part) as refused:
        PathPattern(pattern)
    assert refused.value.places[0].location == "labels"


@given(PARTS, PARTS, PARTS)
def test_what_is_put_into_a_pattern_comes_out(person: str, task: str, source: str) -> None:
    found = PathPattern("{source}/{person}/{task}.bvh").values(f"{source}/{person}/{task}.bvh")
    assert found == {"source": source, "person": person, "task": task}
