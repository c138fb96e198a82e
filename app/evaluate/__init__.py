"""Judges the methods on a library's own labels with the figures of the papers.

Retrieval uses the same rankings as searches. Words and recognition are held out: no clip is judged
by a model that has seen it, or another file of its recording.
"""

from app.evaluate.keyposes.evaluation import (
    JUDGED_KEYPOSES,
    JudgedClip,
    JudgedKeyposes,
    KeyposeEvaluation,
    is_any_annotated,
    judge_keyposes,
)
from app.evaluate.low_dimensional.evaluation import LowDimensionalEvaluation, judge_low_dimensional
from app.evaluate.recognition.evaluation import judge_recognition
from app.evaluate.recognition.methods import METHODS as RECOGNIZERS
from app.evaluate.recognition.results import RecognitionEvaluation
from app.evaluate.retrieval.evaluation import (
    JUDGED,
    MAX_QUERIES,
    JudgedMethod,
    K,
    RetrievalEvaluation,
    RetrievalFigures,
    judge_retrieval,
)
from app.evaluate.retrieval.volumes import VolumeEvaluation, judge_volumes
from app.evaluate.words.captions import CaptionEvaluation, judge_captions
from app.evaluate.words.evaluation import WordExample, draw_words, judge_words, word_examples
from app.evaluate.words.symbols import draw_symbols, judge_symbols

__all__ = [
    "JUDGED",
    "JUDGED_KEYPOSES",
    "MAX_QUERIES",
    "RECOGNIZERS",
    "CaptionEvaluation",
    "JudgedClip",
    "JudgedKeyposes",
    "JudgedMethod",
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
    "judge_captions",
    "judge_keyposes",
    "judge_low_dimensional",
    "judge_recognition",
    "judge_retrieval",
    "judge_symbols",
    "judge_volumes",
    "judge_words",
    "word_examples",
]
