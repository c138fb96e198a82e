"""Words for clips and clips for words (Takano, section 3), held out."""

from __future__ import annotations

from app.models.word_figures import WordEvaluation, held_out_word_figures
from app.services.library import Library
from app.services.training import read_training_set, ready_only
from app.store.clip_filter import ClipFilter


def judge_words(lib: Library, wanted: ClipFilter | None = None) -> WordEvaluation:
    """Held-out figures of the word models beside the prior. Raises NotEnoughLabels."""
    training = read_training_set(lib.store, ready_only(wanted))
    return held_out_word_figures(
        training.symbols, training.statistics, training.label_sets, training.groups
    )
