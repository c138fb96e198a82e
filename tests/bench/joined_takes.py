"""Real clips joined end to end, with the bounds of each, and words that are true of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import BadContent
from app.models.folds import recording_of
from app.models.words.vocabulary import WordVocabulary
from app.numerics.arrays import FloatArray
from tests.real_clips import manifest, real_clips
from tests.streams import body_of, joined

RATE = 30.0
TAKES = 12
"""Takes in one motion."""
SHARE = 0.15
"""A word is true of a take if this share of the takes of its task, or of its style, carry it. Each
take of the data was labeled by another annotator: some say "raise", others "lift"."""
STYLES = frozenset(
    (
        *("active", "feminine", "masculine", "old", "tired", "exhausted", "youthful", "elderly"),
        *("young", "angry", "childish", "happy", "sad"),
    )
)
SEAM = 1.0
"""Seconds between two takes with the same word that count as one moment."""


@dataclass(frozen=True)
class Take:
    """A real clip; body: (frames, 13, 3) at RATE; said: its own words; words: true of it."""

    person: str
    task: str
    recording: str
    body: FloatArray
    said: frozenset[str]
    words: frozenset[str]


@dataclass(frozen=True)
class Joined:
    """A long motion. spans: seconds of each take."""

    body: FloatArray
    takes: tuple[Take, ...]
    spans: tuple[tuple[float, float], ...]

    def moments(self, word: str) -> list[tuple[float, float]]:
        """The parts in which a word is true; neighbors are one."""
        found: list[tuple[float, float]] = []
        for take, (start, end) in zip(self.takes, self.spans, strict=True):
            if word not in take.words:
                continue
            if found and start - found[-1][1] < SEAM:
                found[-1] = found[-1][0], end
            else:
                found.append((start, end))
        return found


def real_takes() -> list[Take]:
    """All real clips that one file describes completely."""
    rows, bodies = [], []
    for row in manifest():
        try:
            bodies.append(body_of((real_clips() / row["path"]).read_bytes(), float(row["fps"])))
        except BadContent:
            continue  # AMC without its ASF
        rows.append(row)
    said = [frozenset(row["words"].split()) for row in rows]
    by_task = _shares(rows, said, lambda row: (_source(row), row["task"]))
    by_person = _shares(rows, said, lambda row: (_source(row), row["person"]))
    return [
        Take(
            person=f"{_source(row)}|{row['person']}",
            task=row["task"],
            recording=_source(row) + recording_of(row["path"]) + row["person"],
            body=body,
            said=own,
            words=own | (acted - STYLES) | (styled & STYLES),
        )
        for row, body, own, acted, styled in zip(
            rows, bodies, said, by_task, by_person, strict=True
        )
    ]


def join_all(takes: Sequence[Take], rng: np.random.Generator) -> list[Joined]:
    """All takes, each once, in motions of TAKES; no two neighbors have the same task."""
    rest = [takes[number] for number in rng.permutation(len(takes))]
    found = []
    while len(rest) >= 4:
        some = [rest.pop()]
        while len(some) < TAKES:
            other = next((i for i, take in enumerate(rest) if take.task != some[-1].task), None)
            if other is None:
                break
            some.append(rest.pop(other))
        stream = joined([take.body for take in some], RATE)
        found.append(Joined(stream.body, tuple(some), stream.spans))
    return found


def _source(row: dict[str, str]) -> str:
    return row["path"].partition("/")[0]


def _shares(
    rows: Sequence[dict[str, str]],
    said: Sequence[frozenset[str]],
    key: Callable[[dict[str, str]], object],
) -> list[frozenset[str]]:
    """For each row, the words that at least SHARE of the rows with the same key carry."""
    vocabulary = WordVocabulary.of([sorted(words) for words in said])
    labels = vocabulary.label_matrix([sorted(words) for words in said])
    groups: dict[object, list[int]] = defaultdict(list)
    for number, row in enumerate(rows):
        groups[key(row)].append(number)
    names = np.array(vocabulary.words)
    of_key = {
        one: frozenset(names[labels[some].mean(axis=0) >= SHARE].tolist())
        for one, some in groups.items()
    }
    return [of_key[key(row)] for row in rows]
