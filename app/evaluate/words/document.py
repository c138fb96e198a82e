"""An evaluation of words as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from app.evaluate.words.evaluation import PAPER, WordExample
from app.models.held_out.words import MIN_RECORDINGS, RECALLS, WordEvaluation


def word_document(found: WordEvaluation, examples: Sequence[WordExample]) -> dict[str, Any]:
    """All results; examples: the queries of table 2."""
    document = asdict(found)
    return document | {
        "recalls": RECALLS.tolist(),
        "least_recordings": MIN_RECORDINGS,
        "paper": PAPER,
        "examples": [asdict(example) for example in examples],
    }
