"""The keyposes of ready clips: those that are found, and those that people annotated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.analysis.energy.energy import EnergyMethod, Weights
from app.analysis.keyposes.keyposes import Keyposes, find_keyposes
from app.models.keyposes.thresholds import USUAL, Thresholds
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.library.keypose_frames import store_keypose_arrays, stored_beats
from app.services.library.keypose_thresholds import learned_thresholds, stored_thresholds
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.store.clips import keypose_annotations
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord, ClipState

METHODS = tuple(method.value for method in EnergyMethod)
WEIGHTS = tuple(weights.value for weights in Weights)


class ThresholdSource(StrEnum):
    """Where a threshold comes from."""

    GIVEN = "given"
    """The client gave it."""

    LEARNED = "learned"
    """It was learned from the clips whose keyposes people annotated."""

    DEFAULT = "default"
    """It is the default of this version of Kinedex."""


@dataclass(frozen=True, slots=True)
class UsedThresholds:
    """T1 and T2, the source of each, and the version of the current model, if it has them."""

    values: Thresholds
    t1_source: ThresholdSource
    t2_source: ThresholdSource
    model_version: int | None


@dataclass(frozen=True, slots=True)
class KeyposesView:
    """Keyposes at the analysis rate (30 Hz), with the pose at each.

    found: frames, times, beats and energy curves; poses: (keyposes, 13, 3) meters, Y up, in
    SUN_ROLES order; named: times of the annotated keyposes, in seconds, None without annotation.
    """

    found: Keyposes
    frame_rate: float
    poses: FloatArray
    thresholds: UsedThresholds
    named: tuple[float, ...] | None


def view(
    lib: Library,
    clip_id: str,
    method: str = EnergyMethod.RMS,
    t1: float | None = None,
    t2: float | None = None,
    *,
    weights: str = Weights.UNIFORM,
) -> KeyposesView:
    """A clip's keyposes by the thresholds T1 and T2 (Perera 2009).

    method: one of METHODS; weights: one of WEIGHTS; t1, t2: None is the threshold of the stored
    keyposes, which segments have too. Raises BadField, ClipNotFound, ClipNotReady.
    """
    for name, value, allowed in (("method", method, METHODS), ("weights", weights, WEIGHTS)):
        if value not in allowed:
            raise fields.bad_field(name, f"must be one of {', '.join(allowed)}")
    clip = ready_clip(lib, clip_id)
    used = thresholds(lib, clip_id, method, t1, t2)
    track = body_track(load_motion(lib, clip))
    found = find_keyposes(
        track,
        method=method,
        weights=weights,
        t1=used.values.t1,
        t2=used.values.t2,
        beats=stored_beats(lib, clip_id),
    )
    with lib.store.read() as tx:
        named = keypose_annotations.get(tx, clip_id)
    return KeyposesView(found, track.rate, track.positions[found.frames], used, named)


def thresholds(
    lib: Library,
    clip_id: str,
    method: str = EnergyMethod.RMS,
    t1: float | None = None,
    t2: float | None = None,
) -> UsedThresholds:
    """The thresholds for a ready clip and an energy method.

    Each is the given one, or else that of the clip's stored keyposes. Those are found by the method
    "rms"; another method has its learned threshold, or else the default one. Raises BadField.
    """
    for name, value in (("t1", t1), ("t2", t2)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise fields.bad_field(name, "must be a number above 0")
    learned, version = learned_thresholds(lib, method)
    is_stored = method == EnergyMethod.RMS
    fallback = stored_thresholds(lib, clip_id) if is_stored else learned or USUAL
    is_default = fallback == USUAL and learned != USUAL
    source = ThresholdSource.DEFAULT if is_default else ThresholdSource.LEARNED
    is_of_model = fallback == learned and (t1 is None or t2 is None)
    return UsedThresholds(
        values=Thresholds(t1 or fallback.t1, t2 or fallback.t2),
        t1_source=source if t1 is None else ThresholdSource.GIVEN,
        t2_source=source if t2 is None else ThresholdSource.GIVEN,
        model_version=version if is_of_model else None,
    )


def annotate_keyposes(lib: Library, clip_id: str, times: Sequence[float]) -> tuple[float, ...]:
    """Store the times of a clip's keyposes, in seconds; an empty list removes the annotation.

    The data that depend on the keyposes of a ready clip are updated at once. Raises BadField for
    a time outside the clip, and ClipNotFound.
    """
    tidy = fields.keyposes(times, "times") or ()
    with lib.store.read() as tx:
        before = clips.get(tx, clip_id)
    _check_within(before, tidy)
    # computed before the transaction, so that no other writer waits for it
    new_times = np.array(tidy) if tidy else _found_times(lib, before)
    with lib.store.write() as tx:
        now = clips.get(tx, clip_id)
        keypose_annotations.put(tx, clip_id, tidy)
        # Found times are of the motion before; a client may have changed a hint meanwhile.
        is_current = bool(tidy) or now.analysis_input == before.analysis_input
        if now.state is ClipState.READY and is_current and new_times is not None:
            store_keypose_arrays(tx, now, new_times)
    return tidy


def _check_within(clip: ClipRecord, times: tuple[float, ...]) -> None:
    if clip.duration is not None and times and times[-1] > clip.duration:
        message = f"{times[-1]:g} s is after the clip's end at {clip.duration:.3f} s"
        raise fields.bad_field("times", message)


def _found_times(lib: Library, clip: ClipRecord) -> FloatArray | None:
    """(k,) seconds of the keyposes found in a ready clip; None if the clip is not ready."""
    if clip.state is not ClipState.READY:
        return None
    track = body_track(load_motion(lib, clip))
    used = stored_thresholds(lib, clip.id)
    return find_keyposes(track, t1=used.t1, t2=used.t2, beats=stored_beats(lib, clip.id)).times
