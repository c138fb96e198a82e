"""The training set of a library's models, read from the store in one snapshot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from app.analysis.symbols.symbol import SYMBOL_ARRAYS, symbol_from_arrays
from app.models.folds import recording_of
from app.models.metric.learned_metric import INPUTS, ClipDescriptors
from app.models.recognition.copies import ClipCopies, disturbed_copies, evenly_chosen
from app.models.recognition.views import full_samples
from app.models.words.language.captions import with_caption_words
from app.models.words.library import TaughtParts
from app.motion.roles.joint_roles import ESSENTIAL_ROLES
from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM
from app.search.index import usable_arrays
from app.services.library.synthesized import SYNTHESIZED, is_synthesized
from app.services.training.taught_spans import NO_SPANS, TaughtSpans, read_taught_spans
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord, ClipState
from app.store.store import Store

WIDE = "wide_motion_vector"
SIGNS = "movement_signs"
NAMES = (*SYMBOL_ARRAYS, *INPUTS, WIDE, SIGNS)
ANGLES = "angle_sample"
POSITIONS = "role_positions"
READY = ClipFilter(state=(ClipState.READY,))


@dataclass(frozen=True, slots=True)
class TrainingSet:
    """N ready clips, sorted by id, at a library version.

    groups: (N,) equal for clips of one recording; symbols: N; statistics: (N, 131); signs: (N, 44);
    samples: (N, 1250) and wide: (N, 512), the widest, float32 as they are stored; vectors: (N,
    128); angles: (642,) by clip id, missing for
    clips of an analysis without joint angles; positions: (n, 13, 3) meters, by the id of the clips
    that are copied (app.models.recognition.copies); is_anonymous: the set has no persons, since
    persons must not be recognized; spans: the annotated parts of the clips.
    """

    library_version: int
    clips: tuple[ClipRecord, ...]
    groups: tuple[str, ...]
    symbols: tuple[GaussianHMM, ...]
    statistics: FloatArray
    signs: FloatArray
    samples: FloatArray
    vectors: FloatArray
    wide: FloatArray
    angles: Mapping[str, FloatArray] = field(default_factory=dict)
    positions: Mapping[str, FloatArray] = field(default_factory=dict)
    is_anonymous: bool = False
    spans: TaughtSpans = NO_SPANS

    def __len__(self) -> int:
        return len(self.clips)

    @property
    def persons(self) -> Sequence[str | None]:
        """(N,) the person of each clip; all None if the set is anonymous."""
        return [None if self.is_anonymous else clip.person for clip in self.clips]

    @property
    def tasks(self) -> Sequence[str | None]:
        """(N,) the task of each clip; None for a clip whose parts have words."""
        in_parts = self.spans.in_parts
        return [None if clip.id in in_parts else clip.task for clip in self.clips]

    @property
    def label_sets(self) -> Sequence[tuple[str, ...]]:
        """(N,) the words of each clip, and those of its captions; none if its parts have words."""
        whole = [clip.id not in self.spans.in_parts for clip in self.clips]
        words = [clip.words if own else () for clip, own in zip(self.clips, whole, strict=True)]
        texts = [clip.captions if own else () for clip, own in zip(self.clips, whole, strict=True)]
        return with_caption_words(words, texts)

    @property
    def taught_parts(self) -> TaughtParts:
        """The annotated parts of the clips, for the word model."""
        place = {clip.id: number for number, clip in enumerate(self.clips)}
        rows = [place[clip_id] for clip_id in self.spans.clip_ids]
        who = [None if self.is_anonymous else person for person in self.spans.persons]
        return TaughtParts(
            inputs=self.spans.inputs,
            label_sets=self.spans.label_sets,
            groups=[self.groups[row] for row in rows],
            persons=[
                self.groups[row] if person is None else f"{self.clips[row].source}|{person}"
                for row, person in zip(rows, who, strict=True)
            ],
        )

    @property
    def word_inputs(self) -> FloatArray:
        """(N, 175) the input of the word model."""
        return np.hstack([self.statistics, self.signs])

    @property
    def strangers(self) -> Sequence[str]:
        """(N,) equal for clips of one person of one source; of one recording without a person."""
        return [
            group if person is None else f"{clip.source}|{person}"
            for clip, person, group in zip(self.clips, self.persons, self.groups, strict=True)
        ]

    def with_angles(self) -> tuple[FloatArray, list[str | None], list[str | None], list[str]]:
        """Angle samples (M, 642), persons, tasks and groups of the clips that have angles."""
        has = [i for i, clip in enumerate(self.clips) if clip.id in self.angles]
        who, what = self.persons, self.tasks
        return (
            _stacked([self.angles[self.clips[i].id] for i in has]),
            [who[i] for i in has],
            [what[i] for i in has],
            [self.groups[i] for i in has],
        )

    @property
    def full_samples(self) -> FloatArray:
        """(N, 1762) the input of the default recognizer."""
        return full_samples(self.samples, self.wide)

    def disturbed_copies(self) -> ClipCopies:
        """(N,) the disturbed copies of some clips. They are computed, which takes seconds."""
        return [
            disturbed_copies(self.positions[clip.id], seed) if clip.id in self.positions else None
            for seed, clip in enumerate(self.clips)
        ]

    @property
    def described(self) -> ClipDescriptors:
        """The input of learned metrics."""
        return ClipDescriptors(self.vectors, self.samples, self.statistics)


def ready_only(filter: ClipFilter | None) -> ClipFilter:
    """The filter, restricted to ready clips that were not synthesized.

    Synthesized clips would judge the methods by their own output.
    """
    given = filter or READY
    refused = (*given.not_source, SYNTHESIZED)
    return replace(given, state=READY.state, not_source=refused)


def read_training_set(store: Store, filter: ClipFilter = READY) -> TrainingSet:
    """Read all clips that pass the filter (by default the ready ones) in one snapshot.

    Synthesized clips and parts of bodies are left out, since models must not learn from them.
    """
    with store.read() as tx:
        version = library.version(tx)
        ids = sorted(clip_listing.list_ids(tx, filter))
        found = {name: usable_arrays.get_many(tx, ids, name) for name in NAMES}
        whole = [clip_id for clip_id in ids if all(clip_id in part for part in found.values())]
        records = clips.get_many(tx, whole)
        angles = usable_arrays.get_many(tx, whole, ANGLES)
        whole = [clip_id for clip_id in whole if _teaches(records[clip_id])]
        spans = read_taught_spans(tx, {clip_id: records[clip_id] for clip_id in whole})
        copied = [whole[i] for i in evenly_chosen(len(whole))]
        positions = usable_arrays.get_many(tx, copied, POSITIONS)
    return TrainingSet(
        library_version=version,
        clips=tuple(records[clip_id] for clip_id in whole),
        groups=tuple(recording_of_clip(records[clip_id]) for clip_id in whole),
        symbols=tuple(
            symbol_from_arrays({name: found[name][clip_id] for name in SYMBOL_ARRAYS})
            for clip_id in whole
        ),
        statistics=_stacked([found["symbol_statistics"][clip_id] for clip_id in whole]),
        signs=_stacked([found[SIGNS][clip_id] for clip_id in whole]),
        samples=_stacked([found["motion_sample"][clip_id] for clip_id in whole], np.float32),
        vectors=_stacked([found["motion_vector"][clip_id] for clip_id in whole]),
        wide=_stacked([found[WIDE][clip_id] for clip_id in whole], np.float32),
        angles=angles,
        positions=positions,
        spans=spans,
    )


def _teaches(clip: ClipRecord) -> bool:
    """Whether models learn from a clip: it was recorded, and is no lower or upper body alone.

    An edited copy teaches nothing new, and would be held out from its own original. If the original
    was deleted, the copy takes its place.
    """
    is_part = any(role.value in clip.missing_roles for role in ESSENTIAL_ROLES)
    is_copy = clip.origin is not None and not clip.origin.is_deleted
    return not is_part and not is_copy and not is_synthesized(clip)


def recording_of_clip(clip: ClipRecord) -> str:
    """The key of a recording: the file name without its ending, and the labels.

    The labels are needed since libraries use the same name for takes of different people.
    """
    return f"{recording_of(clip.file_name)}|{clip.person}|{clip.task}"


def _stacked(rows: list[FloatArray], kind: type[np.floating[Any]] = np.float64) -> FloatArray:
    return np.stack(rows, dtype=kind, casting="same_kind") if rows else np.zeros((0, 0))
