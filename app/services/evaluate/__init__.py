"""How good the methods are on a library's own labels: the figures of the papers.

Retrieval goes through the very ranking that searches use. Words and recognition are held
out: no clip is judged by a model that has seen it, or another file of its recording.
"""

from app.services.evaluate.keyposes import (
    JUDGED_KEYPOSES,
    JudgedClip,
    JudgedKeyposes,
    KeyposeEvaluation,
    is_any_annotated,
    judge_keyposes,
)
from app.services.evaluate.low_dimensional import LowDimensionalEvaluation, judge_low_dimensional
from app.services.evaluate.recognition import judge_recognition
from app.services.evaluate.recognition_methods import METHODS as RECOGNISERS
from app.services.evaluate.recognition_results import RecognitionEvaluation
from app.services.evaluate.retrieval import (
    JUDGED,
    MOST_QUERIES,
    JudgedWay,
    K,
    RetrievalEvaluation,
    RetrievalFigures,
    judge_retrieval,
)
from app.services.evaluate.symbols import draw_symbols, judge_symbols
from app.services.evaluate.volumes import VolumeEvaluation, judge_volumes
from app.services.evaluate.words import WordExample, draw_words, judge_words, word_examples

__all__ = [
    "JUDGED",
    "JUDGED_KEYPOSES",
    "MOST_QUERIES",
    "RECOGNISERS",
    "JudgedClip",
    "JudgedKeyposes",
    "JudgedWay",
    "K",
    "KeyposeEvaluation",
    "LowDimensionalEvaluation",
    "RecognitionEvaluation",
    "RetrievalEvaluation",
    "RetrievalFigures",
    "VolumeEvaluation",
    "WordExample",
    "draw_symbols",
    "draw_words",
    "is_any_annotated",
    "judge_keyposes",
    "judge_low_dimensional",
    "judge_recognition",
    "judge_retrieval",
    "judge_symbols",
    "judge_volumes",
    "judge_words",
    "word_examples",
]
