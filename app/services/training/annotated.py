"""Clips with keyposes that people annotated. Thresholds are learned and judged on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.rhythm.beats import Beats
from app.motion.frame.body_frame import BodyTrack, body_track
from app.numerics.arrays import FloatArray
from app.services.library.keypose_frames import read_beats
from app.services.library.stored_motion import read_motion
from app.services.training.training_set import ready_only, recording_of_clip
from app.store.clips import keypose_annotations
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx
from app.store.store import Store


@dataclass(frozen=True, slots=True)
class AnnotatedClip:
    """A ready clip with an annotation.

    true: (k,) times of the annotated keyposes in seconds; beats: of the clip, None if its
    analysis is older than the storage of beats; group: equal for files of one recording.
    """

    clip: ClipRecord
    group: str
    track: BodyTrack
    beats: Beats | None
    true: FloatArray


def annotated_ids(store: Store, filter: ClipFilter | None = None) -> tuple[str, ...]:
    """The ids of the ready clips that have an annotation and pass the filter."""
    with store.read() as tx:
        return _annotated_ids(tx, filter)


def read_annotated(store: Store, filter: ClipFilter | None = None) -> tuple[AnnotatedClip, ...]:
    """The ready clips that have an annotation and pass the filter, sorted by name and id."""
    with store.read() as tx:
        ids = _annotated_ids(tx, filter)
        found = clips.get_many(tx, ids)
        named = keypose_annotations.get_many(tx, ids)
        tracks = {clip.id: body_track(read_motion(tx, clip)) for clip in found.values()}
        beats = {clip_id: read_beats(tx, clip_id) for clip_id in found}
    return tuple(
        AnnotatedClip(
            clip=clip,
            group=recording_of_clip(clip),
            track=tracks[clip.id],
            beats=beats[clip.id],
            true=np.array([time for time in named[clip.id] if time <= tracks[clip.id].duration]),
        )
        for clip in sorted(found.values(), key=lambda each: (each.name, each.id))
    )


def _annotated_ids(tx: Tx, filter: ClipFilter | None) -> tuple[str, ...]:
    ready = set(clip_listing.list_ids(tx, ready_only(filter)))
    return tuple(clip_id for clip_id in keypose_annotations.annotated(tx) if clip_id in ready)
