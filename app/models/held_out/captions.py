"""How well captions find their clips: recall at ranks, and the median rank.

The protocols are those of text-to-motion retrieval (Petrovich, Black and Varol 2023, "TMR", section
4.1): all captions among all clips; with a threshold, where a clip counts as right if its caption
means about the same; a distinct subset of captions, among their own clips; and batches of 32 clips.
Here the likeness of two captions is the cosine of their words, each weighted by how rare it is, and
not that of a language model. Shapes: captions Q, clips N.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.models.words.language.captions import caption_words
from app.numerics.arrays import BoolArray, FloatArray, IntArray

RECALLS_AT = (1, 5, 10)
THRESHOLD = 0.95
"""The likeness from which two captions mean the same."""
BATCH = 32
"""Clips of a batch: the right one, and others at random."""
BATCHES = 20
"""Batches of each caption; the figures are their means."""
CHANCES = 200
"""Random rankings from which chance is estimated."""


@dataclass(frozen=True, slots=True)
class CaptionFigures:
    """Figures of one protocol. captions, clips: their numbers; recalls: at RECALLS_AT, 0..1;
    median_rank: of the best right clip, from 1; chance: the same figures of random rankings."""

    protocol: str
    captions: int
    clips: int
    recalls: tuple[float, ...]
    median_rank: float
    chance_recalls: tuple[float, ...]
    chance_median_rank: float


def caption_likeness(captions: Sequence[str]) -> FloatArray:
    """(Q, Q) likeness of captions, 0..1; 1 for equal captions, also for those without a word."""
    words = [caption_words([text]) for text in captions]
    clips_of = Counter(word for one in words for word in one)
    names = {word: column for column, word in enumerate(clips_of)}
    table = np.zeros((len(captions), len(names)))
    for row, one in enumerate(words):
        for word in one:
            table[row, names[word]] = np.log(1.0 + len(captions) / clips_of[word])
    lengths = np.maximum(np.linalg.norm(table, axis=1, keepdims=True), 1e-12)
    likeness = (table / lengths) @ (table / lengths).T
    same = np.array(captions)[:, None] == np.array(captions)[None]
    return np.where(same, 1.0, np.clip(likeness, 0.0, 1.0))


def caption_figures(
    scores: FloatArray, own: IntArray, captions: Sequence[str], *, seed: int = 0
) -> tuple[CaptionFigures, ...]:
    """The figures of all protocols.

    scores: (Q, N), higher is closer; own: (Q,) the column of the clip of each of Q >= 1 captions.
    Deterministic for a seed.
    """
    count, clips = scores.shape
    right = np.zeros(scores.shape, dtype=bool)
    right[np.arange(count), own] = True
    likeness = caption_likeness(captions)
    similar = np.zeros(scores.shape, dtype=bool)
    for row, other in zip(*np.nonzero(likeness >= THRESHOLD), strict=True):
        similar[row, own[other]] = True
    distinct = _distinct(likeness, own)
    subset = np.ix_(distinct, own[distinct])
    rng = np.random.default_rng(seed)
    return (
        _figures("all", scores, right, rng),
        _figures("threshold", scores, similar, rng),
        _figures("distinct", scores[subset], right[subset], rng),
        _figures("batches", *_batches(scores, own, min(BATCH, clips), rng), rng),
    )


def ranks(scores: FloatArray, right: BoolArray) -> FloatArray:
    """(Q,) the rank from 1 of the best right clip of each caption.

    scores, right: (Q, N). Among clips with equal scores, the rank is the mean over their orders of
    the first right one.
    """
    best = np.where(right, scores, -np.inf).max(axis=1, keepdims=True)
    closer = (scores > best).sum(axis=1)
    equal, own = (scores == best).sum(axis=1), ((scores == best) & right).sum(axis=1)
    return np.asarray(closer + (equal + 1.0) / (own + 1.0))


def _figures(
    protocol: str, scores: FloatArray, right: BoolArray, rng: np.random.Generator
) -> CaptionFigures:
    found = ranks(scores, right)
    drawn = np.concatenate([ranks(rng.random(scores.shape), right) for _ in range(CHANCES)])
    return CaptionFigures(
        protocol=protocol,
        captions=len(scores),
        clips=scores.shape[1],
        recalls=_recalls(found),
        median_rank=float(np.median(found)),
        chance_recalls=_recalls(drawn),
        chance_median_rank=float(np.median(drawn)),
    )


def _recalls(found: FloatArray) -> tuple[float, ...]:
    return tuple(float((found <= rank).mean()) for rank in RECALLS_AT)


def _distinct(likeness: FloatArray, own: IntArray) -> IntArray:
    """Rows of captions that mean something else than all rows before, each of another clip."""
    chosen: list[int] = []
    for row in range(len(likeness)):
        if all(likeness[row, one] < THRESHOLD and own[row] != own[one] for one in chosen):
            chosen.append(row)
    return np.array(chosen, dtype=np.int64)


def _batches(
    scores: FloatArray, own: IntArray, size: int, rng: np.random.Generator
) -> tuple[FloatArray, BoolArray]:
    """(Q BATCHES, size) scores of the right clip, which is the first, and of random others."""
    rows = []
    for row, column in enumerate(own):
        others = np.delete(np.arange(scores.shape[1]), column)
        rows += [
            scores[row, [column, *rng.choice(others, size - 1, replace=False)]]
            for _ in range(BATCHES)
        ]
    right = np.zeros((len(rows), size), dtype=bool)
    right[:, 0] = True
    return np.array(rows), right
