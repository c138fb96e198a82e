"""Words that the word model suggests for a clip, and completions of the beginning of a word."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.models.words.language.inflection import base_forms
from app.models.words.language.normalize import normalize_word
from app.services import fields
from app.services.clips import labels
from app.services.clips.catalogue import get_clip, update_clip
from app.services.clips.labels import LabelCount
from app.services.find.by_words import word_arrays, word_scores
from app.services.find.queries import WORD_MODES
from app.services.library.library import Library
from app.services.library.ready_clips import descriptors_of, ready_clip
from app.store.clips.record import ClipRecord

LIKELY = 0.5
"""Score from which a suggestion is accepted by default: more likely than not."""
MAX_SUGGESTED = 100

Suggestions = tuple[tuple[str, float], ...]
"""(word, score 0..1), the best first."""


def suggest(lib: Library, clip_id: str, limit: int = 10, mode: str = "default") -> Suggestions:
    """Words that the clip does not carry but that the word model predicts for it.

    mode: "default" predicts by kernel regression; "cca" and "printed" by the position of the clip's
    symbol in the correlated space. Raises ClipNotFound, ClipNotReady, ModelNotFitted, BadField, and
    NotEnoughLabels if these modes could not be fitted.
    """
    if not 1 <= limit <= MAX_SUGGESTED:
        raise fields.bad_field("limit", f"must be from 1 to {MAX_SUGGESTED}")
    if mode not in WORD_MODES:
        raise fields.bad_field("mode", f"must be one of {', '.join(WORD_MODES)}")
    clip = ready_clip(lib, clip_id)
    model = lib.models.words(lib.store).model
    with lib.store.read() as tx:
        arrays = descriptors_of(tx, clip, word_arrays(mode))
    scores = word_scores(model, arrays, mode)
    carried = model.vocabulary.label_matrix([clip.words])[0] > 0
    order = np.argsort(-np.where(carried, -1.0, scores), kind="stable")
    found = [(model.vocabulary.words[i], float(scores[i])) for i in order if not carried[i]]
    return tuple(pair for pair in found[:limit] if pair[1] > 0)


def accept(lib: Library, clip_id: str, words: Sequence[str] | None = None) -> ClipRecord:
    """Add these words to the clip's own; by default the suggestions with a score of LIKELY or more.

    The next fit learns from them. Raises ClipNotFound, BadField; by default also ClipNotReady
    and ModelNotFitted.
    """
    if words is None:
        words = [word for word, score in suggest(lib, clip_id, MAX_SUGGESTED) if score >= LIKELY]
    new = fields.words(words) or ()
    carried = get_clip(lib, clip_id).words
    return update_clip(lib, clip_id, {"words": (*carried, *new)})


def complete(lib: Library, beginning: str, limit: int = 10) -> list[LabelCount]:
    """The library's words that begin with `beginning`, then words that contain it.

    In each group the most frequent words are first. If there are no such words, `beginning` may
    be an inflected word ("walked"): then these are its base forms ("walk").
    """
    typed, carried = normalize_word(beginning), labels.words(lib)
    found = [word for word in carried if typed in word.name]
    if not found:
        forms = base_forms(typed)
        found = [word for word in carried if word.name in forms]
    found.sort(key=lambda word: (not word.name.startswith(typed), -word.recordings, word.name))
    return found[:limit]
