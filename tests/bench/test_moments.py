"""Words find moments in long motion: clips joined end to end, with known bounds.

Run: pytest -m bench -s tests/bench/test_moments.py
A third of the recordings is held out in turn: they are joined to long motions, twelve takes each
with 0.6 s between them, and stored; the other clips teach the word model. Then each word that
enough taught clips carry is asked with scope "windows". A hit is relevant if it is the first that
overlaps a moment (intersection at least half of the union). The same with a third of the persons
held out. All other hits count as wrong. By chance: the same number of moments, of the same lengths,
anywhere.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from app.config import Settings
from app.errors import NotEnoughLabels
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.find.queries import WordQuery
from app.services.library.fitted_models import ModelKind
from app.services.library.library import Library
from app.services.training import fit
from tests.bench.joined_takes import RATE, STYLES, Joined, Take, join_all, real_takes
from tests.bench.page import Section
from tests.libraries import work
from tests.streams import npz_of

FIGURES = Section(
    "moments",
    "Words find moments in long motion",
    trials="each word in each of three thirds that are held out in turn",
    chance="moments of the same lengths at random times, printed as `chance`",
)

pytestmark = pytest.mark.bench

FOLDS = 3
FEW, ENOUGH = 3, 10
"""Taught clips that carry a word: with FEW it is asked, with ENOUGH it counts for the floor."""
STREAMS = "joined"
LIMIT = 5
FLOOR = 0.8

Span = tuple[int, float, float]


@dataclass(frozen=True)
class Asked:
    """A word in one third: how many taught clips carry it, its moments, and AP@5."""

    word: str
    taught: int
    moments: int
    average: float
    chance: float


@pytest.fixture(scope="module")
def takes() -> list[Take]:
    return real_takes()


@pytest.fixture(autouse=True)
def fit_only_words(monkeypatch: pytest.MonkeyPatch) -> None:
    """The other models take most of the time of a fit, and so do the figures of the word model."""

    def skip(*_: object) -> fit.Fit:
        raise NotEnoughLabels

    only_words = {ModelKind.WORDS: fit._FITS[ModelKind.WORDS]}
    monkeypatch.setattr(fit, "_FITS", dict.fromkeys(ModelKind, skip) | only_words)
    monkeypatch.setattr(fit, "word_figures", lambda _training: {})


@pytest.mark.parametrize("kind", ["recording", "person"])
def test_words_find_moments(takes: list[Take], kind: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    names = sorted({getattr(take, kind) for take in takes})
    fold_of = dict(zip(names, rng.permutation(len(names)) % FOLDS, strict=True))
    found: list[Asked] = []
    for fold in range(FOLDS):
        held_out = [take for take in takes if fold_of[getattr(take, kind)] == fold]
        taught = [take for take in takes if fold_of[getattr(take, kind)] != fold]
        found += _of_fold(taught, held_out, rng, tmp_path / str(fold))
    FIGURES.print(f"\nheld out by {kind}: {len(found)} trials")
    enough = [one for one in found if one.taught >= ENOUGH]
    for name, some in (
        (f"words of {ENOUGH} and more taught clips", enough),
        ("of these, actions", [one for one in enough if one.word not in STYLES]),
        (f"words of {FEW} and more taught clips", found),
    ):
        average, chance = (
            np.mean([getattr(one, figure) for one in some]) for figure in ("average", "chance")
        )
        FIGURES.print(f"{name:36}{len(some):4} trials  AP@5 {average:.3f}  chance {chance:.3f}")
    by_word: dict[str, list[float]] = {}
    for one in found:
        by_word.setdefault(one.word, []).append(one.average)
    shown = sorted((float(np.mean(some)), word) for word, some in by_word.items())
    FIGURES.print(", ".join(f"{word} {average:.2f}" for average, word in shown))
    if kind == "recording":
        assert np.mean([one.average for one in enough]) >= FLOOR


def _of_fold(
    taught: list[Take], held_out: list[Take], rng: np.random.Generator, folder: Path
) -> list[Asked]:
    settings = Settings(data_dir=folder / "data", refit_growth=1e9, analysis_processes=2)
    lib = Library.open(settings)
    try:
        for number, take in enumerate(taught):
            labels = {"person": take.person, "task": take.task, "words": sorted(take.said)}
            _store(lib, take.body, f"{take.recording} {number}", {**labels, "source": "taught"})
        streams = join_all(held_out, rng)
        numbers = {
            _store(lib, stream.body, f"{STREAMS} {number}", {"source": STREAMS}): number
            for number, stream in enumerate(streams)
        }
        work(settings)
        fit.fit_library(lib.store)
        return list(_asked(lib, taught, streams, numbers, rng))
    finally:
        lib.close()


def _store(lib: Library, body: np.ndarray, name: str, labels: dict[str, object]) -> str:
    # Slashes would be folders of the name.
    content = io.BytesIO(npz_of(body, RATE))
    return clips.create_clip(lib, content, f"{name.replace('/', ' ')}.npz", labels).clip.id


def _asked(
    lib: Library,
    taught: list[Take],
    streams: list[Joined],
    numbers: dict[str, int],
    rng: np.random.Generator,
) -> Iterator[Asked]:
    words = sorted({word for take in taught for word in take.said})
    for word in words:
        count = sum(word in take.said for take in taught)
        truth = [
            (number, *span) for number, one in enumerate(streams) for span in one.moments(word)
        ]
        if count < FEW or not truth:
            continue
        query = WordQuery([word], scope="windows", limit=LIMIT, filter={"source": STREAMS})
        hits = [
            (numbers[hit.clip.id], hit.start, hit.end) for hit in find.find_words(lib, query).items
        ]
        guesses = [_average(_guessed(truth, streams, rng), truth) for _ in range(20)]
        yield Asked(word, count, len(truth), _average(hits, truth), float(np.mean(guesses)))


def _guessed(truth: list[Span], streams: list[Joined], rng: np.random.Generator) -> list[Span]:
    """Five moments at random, as long as true ones."""
    found = []
    for _ in range(LIMIT):
        _, start, end = truth[rng.integers(len(truth))]
        number = int(rng.integers(len(streams)))
        at = rng.uniform(0.0, max(streams[number].spans[-1][1] - (end - start), 0.01))
        found.append((number, at, at + end - start))
    return found


def _average(hits: list[Span], truth: list[Span], least: float = 0.5) -> float:
    """AP@5."""
    left, found = list(truth), []
    for hit in hits[:LIMIT]:
        match = next((span for span in left if _overlap(hit, span) >= least), None)
        found.append(match is not None)
        if match is not None:
            left.remove(match)
    row = np.array(found, dtype=float)
    precision = np.cumsum(row) / np.arange(1, len(row) + 1)
    return float((row * precision).sum() / min(LIMIT, len(truth)))


def _overlap(one: Span, other: Span) -> float:
    """Intersection over union; 0 in another motion."""
    shared = min(one[2], other[2]) - max(one[1], other[1])
    if one[0] != other[0] or shared <= 0:
        return 0.0
    return shared / (one[2] - one[1] + other[2] - other[1] - shared)
