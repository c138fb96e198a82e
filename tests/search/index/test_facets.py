"""Facets compared with counters over the clips."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from app.search.index import facets as counted
from app.search.index.facets import facets
from app.search.index.labels import Labels
from tests.search.indexed import indexed

ROWS = [
    ("ada", ("slow", "sad"), 1.0),
    ("ada", (), 3.0),
    (None, ("slow",), 2.0),
    ("bruno", ("fast",), 10.0),
    ("bruno", ("fast",), 4.0),
]


@pytest.fixture
def labels() -> Labels:
    labels = Labels()
    clips = [
        indexed(f"clip_{n}", person=person, words=frozenset(words), duration=seconds)
        for n, (person, words, seconds) in enumerate(ROWS)
    ]
    labels.add(clips)
    return labels


def test_labels_and_words_are_counted(labels: Labels) -> None:
    chosen = np.array([0, 1, 2, 3])
    found = facets(labels.view(), chosen, ["person", "word", "task"])
    persons = Counter(ROWS[n][0] for n in chosen)
    assert found["person"].missing == persons.pop(None)
    assert dict(found["person"].values) == persons
    assert found["person"].values[0] == ("ada", 2)
    words = Counter(word for n in chosen for word in ROWS[n][1])
    assert dict(found["word"].values) == words
    assert found["word"].missing == 1
    assert (found["task"].values, found["task"].missing) == ((), 4)


def test_measures_have_quartiles(labels: Labels) -> None:
    found = facets(labels.view(), np.arange(5), ["duration", "speed", "foot_skate"])
    seconds = [seconds for *_, seconds in ROWS]
    assert found["duration"].quartiles == pytest.approx(
        np.percentile(seconds, [0, 25, 50, 75, 100])
    )
    for name in ("speed", "foot_skate"):
        assert (found[name].quartiles, found[name].missing) == (None, 5)


def test_rare_values_are_others(labels: Labels, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(counted, "MOST_VALUES", 1)
    found = facets(labels.view(), np.arange(5), ["person"])["person"]
    assert (found.values, found.others, found.missing) == ((("ada", 2),), 2, 1)


def test_no_clips_have_no_values(labels: Labels) -> None:
    for found in facets(labels.view(), np.array([], dtype=int), counted.NAMES).values():
        assert (found.values, found.others, found.missing, found.quartiles) == ((), 0, 0, None)
