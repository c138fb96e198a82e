"""Annotated parts of clips as samples of their own for the word model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from app.analysis.descriptors.word_windows import INPUT_WIDTH, word_inputs
from app.analysis.symbols.channels import symbol_features
from app.models.words.language.captions import with_caption_words
from app.motion.frame.body_frame import smooth_track
from app.numerics.arrays import FloatArray
from app.services.library.stored_motion import read_motion
from app.store.clips import clip_annotations
from app.store.clips.clip_annotations import Annotation
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx

MIN_SECONDS = 0.4
"""A shorter part holds no movement that has a name."""
MAX_TAUGHT = 10_000
"""The largest number of parts that teach. To describe one takes 3 ms of CPU time."""


@dataclass(frozen=True, slots=True)
class TaughtSpans:
    """M annotated parts of clips that have words.

    inputs: (M, 175) of the word model; label_sets: M, their words and those of their sentences;
    clip_ids: M, the clip of each; persons: M, who moves, None if nobody said it. in_parts: ids of
    the clips whose parts have words: what is said about such a clip as a whole teaches no model of
    words or tasks, because it is true of only some of its parts.
    """

    inputs: FloatArray = field(default_factory=lambda: np.zeros((0, INPUT_WIDTH)))
    label_sets: Sequence[tuple[str, ...]] = ()
    clip_ids: Sequence[str] = ()
    persons: Sequence[str | None] = ()
    in_parts: frozenset[str] = frozenset()

    def __len__(self) -> int:
        return len(self.label_sets)


NO_SPANS = TaughtSpans()


def read_taught_spans(tx: Tx, clips: Mapping[str, ClipRecord]) -> TaughtSpans:
    """The annotated parts of ready clips, by clip and start."""
    ids = [clip_id for clip_id in clip_annotations.annotated(tx) if clip_id in clips]
    said = clip_annotations.get_many(tx, ids)
    worded = [
        (clip_id, one)
        for clip_id in ids
        for one in clip_annotations.within(said[clip_id], clips[clip_id].duration or 0.0)
        if one.words and one.end - one.start >= MIN_SECONDS
    ]
    chosen = np.unique(np.linspace(0, len(worded) - 1, min(len(worded), MAX_TAUGHT)).round())
    spans = [worded[int(number)] for number in chosen]
    if not spans:
        return NO_SPANS
    parts: dict[str, list[Annotation]] = {}
    for clip_id, one in spans:
        parts.setdefault(clip_id, []).append(one)
    inputs = [_inputs(tx, clips[clip_id], some) for clip_id, some in parts.items()]
    texts = [(one.text,) if one.text else () for _, one in spans]
    return TaughtSpans(
        inputs=np.vstack(inputs),
        label_sets=with_caption_words([one.words for _, one in spans], texts),
        clip_ids=[clip_id for clip_id, _ in spans],
        persons=[one.person or clips[clip_id].person for clip_id, one in spans],
        in_parts=frozenset(clip_id for clip_id, _ in worded),
    )


def _inputs(tx: Tx, clip: ClipRecord, parts: Sequence[Annotation]) -> FloatArray:
    """(m, 175) the inputs of the word model for parts of a clip."""
    track = smooth_track(read_motion(tx, clip))
    channels = symbol_features(track)
    rows = []
    for part in parts:
        first = min(round(part.start * track.rate), max(track.frames - 2, 0))
        stop = min(max(round(part.end * track.rate), first + 2), track.frames)
        rows.append(word_inputs(track, channels, np.array([first]), stop - first))
    return np.vstack(rows)
