"""The README's picture shows the hits and scores of the demo library."""

from __future__ import annotations

import re

import pytest

from tests.picture import PICTURE, captions, demo_library, search

_CAPTION = re.compile(r'<text [^>]*font-size="12"[^>]*>([^<]*)</text>')


def shown() -> list[str]:
    return _CAPTION.findall(PICTURE.read_text())


def test_the_picture_has_a_query_and_five_hits_by_score() -> None:
    query, *hits = shown()
    assert query == "query: chika, kick_01"
    scores = [float(hit.rpartition(" ")[2]) for hit in hits]
    assert len(scores) == 5
    assert scores == sorted(scores, reverse=True)


@pytest.mark.slow
def test_the_picture_shows_the_scores_of_the_demo() -> None:
    """If it fails, run `make picture`, look at the picture, and commit it."""
    with demo_library() as lib:
        assert captions(*search(lib)) == shown()
