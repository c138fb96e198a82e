"""The analysis of a motion: all arrays that are stored for a clip, by name.

Arrays (float32 if nothing else is said; n frames at 30 Hz, m at 10 Hz; a frames of the active
part at 30 Hz): role_positions (n, 13, 3) meters, world; features_10hz (m, 82); active_span (2,)
seconds; motion_vector (128,); paced_vector (128,), the same at a common pace;
wide_motion_vector (512,); msv_lambda (1,), msv_rho (13,),
msv_epsilon (a,), msv_convergence (i, 2), the error and the change of lambda after each of
i iterations; motion_sample (1250,);
angle_sample (642,); motion_shape (1378,); symbol_statistics (131,); movement_signs (44,);
window_vectors_* (w, 125)
float16 and window_spans_* (w, 2) seconds, for 1s, 2s and 4s; beat_times (b,) float64
seconds, beat_facts (3,) float64 (see `rhythm`); keypose_frames (k,)
int32, indices of the n frames; keypose_thresholds (2,) float64, the T1 and T2 that found them;
moments (q, 33), the time in seconds and the vector of moments that copies of a take have too;
pose_cover (p, 38), the frame, radius and vector of
poses that represent all poses; segment_spans (s, 2) seconds, segment_vectors (s, 185)
float16, segment_cycles (c, 3) int32. word_windows (w, 175) float16 and word_window_spans (w, 2)
seconds (see `word_windows`). The motion symbol, with K states, has
symbol_means (K, 26), symbol_variances (K, 26) and symbol_transitions (K, K).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.descriptors.active_part import active_span
from app.analysis.descriptors.angle_sample import angle_sample
from app.analysis.descriptors.common_pace import at_common_pace
from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.analysis.descriptors.moments import moments
from app.analysis.descriptors.motion_sample import motion_sample
from app.analysis.descriptors.motion_shape import motion_shape
from app.analysis.descriptors.motion_vector import describe, motion_vector, narrow, wide
from app.analysis.descriptors.motion_volume import decompose
from app.analysis.descriptors.movement_signs import signs_of_parts
from app.analysis.descriptors.pose_cover import pose_cover
from app.analysis.descriptors.sign_series import SignSeries
from app.analysis.descriptors.windows import WINDOW_SCALES, window_arrays
from app.analysis.descriptors.word_windows import word_window_arrays
from app.analysis.energy.energy import energies
from app.analysis.keyposes.keyposes import T1, T2, find_keyposes
from app.analysis.measures import Measures, measure
from app.analysis.quality.measure import Quality, measure_quality
from app.analysis.rhythm.onsets import Onsets
from app.analysis.rhythm.rhythm import NO_RHYTHM_INPUT, RhythmInput, find_rhythm, rhythm_arrays
from app.analysis.segments.keypose_arrays import keypose_arrays
from app.analysis.stage_times import StageTimes
from app.analysis.symbols.channels import symbol_features, symbol_statistics
from app.analysis.symbols.symbol import SYMBOL_ARRAYS, describe_symbol
from app.motion.frame.body_frame import BodyTrack, both_tracks, smooth_track
from app.motion.frame.gait import exact_gait_cycles
from app.motion.frame.posed_start import posed_frames
from app.motion.motion import Motion
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray
from app.numerics.tensors.rank1 import Rank1

ANALYSIS_VERSION = 9
"""Raise this number if the content of an array changes. Older clips are then analyzed again."""


@dataclass(frozen=True, slots=True)
class Analysis:
    """A motion and its arrays by name (see the module).

    audio_offset: the time of the motion, in seconds, at which its audio recording begins; None
    without a recording or if the time is unknown. cautions: doubts about the recording. measures,
    quality: None if only the arrays of a search were computed.
    stage_seconds: how long each stage took, for the operator; it is not part of the result.
    """

    motion: Motion
    arrays: dict[str, NDArray[Any]]
    audio_offset: float | None = None
    cautions: tuple[Caution, ...] = ()
    measures: Measures | None = None
    quality: Quality | None = None
    stage_seconds: Mapping[str, float] = field(default_factory=dict, compare=False)


def analyze(
    motion: Motion,
    *,
    t1: float = T1,
    t2: float = T2,
    rhythm_input: RhythmInput = NO_RHYTHM_INPUT,
    onsets: Onsets | None = None,
    times: StageTimes | None = None,
) -> Analysis:
    """Compute all arrays of `motion`.

    t1, t2: the thresholds of its keyposes (see `keyposes`). rhythm_input: what a client says
    about its beats. onsets: those of its audio recording, None without one. times: measures the
    stages. The result is deterministic. Raises TooShort or NotHuman.
    """
    times = times or StageTimes()
    with times.stage("describe"):
        track, smooth = both_tracks(motion)
        parts = _Parts(smooth)
        arrays: dict[str, NDArray[Any]] = {**_for_search(parts)}
        arrays |= word_window_arrays(parts.sign_series, parts.channels_of_track)
        arrays["moments"] = moments(parts.track)
    with times.stage("symbol"):
        arrays |= parts.symbol
    with times.stage("rhythm"):
        rms_energies = energies(track)
        rhythm = find_rhythm(track, rhythm_input, onsets, rms_energies)
        arrays |= rhythm_arrays(rhythm)
    with times.stage("keyposes"):
        keyposes = find_keyposes(
            track, t1=t1, t2=t2, beats=rhythm.beats, rms_energies=rms_energies
        ).frames
        arrays["pose_cover"] = pose_cover(arrays["role_positions"], keyposes)
        arrays |= keypose_arrays(keyposes, arrays["features_10hz"])
        arrays["keypose_thresholds"] = np.array([t1, t2], dtype=np.float64)
    offset = None if rhythm.offset is None else rhythm.offset.seconds
    with times.stage("measures"):
        measures = measure(track, rms_energies, rhythm.beats.tempo)
        quality = measure_quality(track, parts.track, arrays["movement_signs"])
    cautions = (*_of_start(motion), *rhythm.cautions)
    return Analysis(motion, arrays, offset, cautions, measures, quality, times.seconds)


def _of_start(motion: Motion) -> tuple[Caution, ...]:
    """The doubt about a pose at the start, if there is one."""
    posed = posed_frames(motion)
    if not posed:
        return ()
    what = "The first frame is a pose" if posed == 1 else f"The first {posed} frames are a pose"
    detail = f"{what} that does not belong to the motion. No analysis reads it."
    return (Caution("posed_start", detail, frames=(0, posed)),)


def describe_for_search(motion: Motion, names: Collection[str] | None = None) -> Analysis:
    """Compute only the arrays that search and recognition need.

    Keyposes, windows for words, and the motion symbol, which is slow, are left out. names: the
    arrays to compute, those of the symbol too; None computes all that search needs, in about 10 ms
    for 5 s of motion.
    Each array is the same as from `analyze`. Raises KeyError for a name that only `analyze`
    computes, and TooShort or NotHuman.
    """
    return Analysis(motion, {**_for_search(_Parts(smooth_track(motion)), names)})


class _Parts:
    """Parts from which the arrays are made. Each is computed once, when it is first needed."""

    def __init__(self, track: BodyTrack) -> None:
        self.track = track

    @cached_property
    def span(self) -> tuple[int, int]:
        """The first frame of the active part, and the frame after its last."""
        return active_span(self.track)

    @cached_property
    def active(self) -> BodyTrack:
        """The active part of the track, which descriptors of the whole clip are computed from."""
        return self.track.part(*self.span)

    @property
    def is_whole(self) -> bool:
        """Whether the whole track is active."""
        return self.active.frames == self.track.frames

    @cached_property
    def features(self) -> FloatArray:
        """(n, 82) the frame features at 30 Hz."""
        return frame_features(self.track)

    @cached_property
    def features_10hz(self) -> FloatArray:
        """(m, 82) the frame features at 10 Hz."""
        return features_at_10hz(self.features, self.track.rate)

    @cached_property
    def described(self) -> FloatArray:
        """(3606,) the numbers from which motion vectors are projected."""
        return describe(self.features if self.is_whole else frame_features(self.active))

    @cached_property
    def paced_vector(self) -> FloatArray:
        """(128,) the motion vector of the active part at a common pace."""
        return motion_vector(frame_features(at_common_pace(self.active)))

    @cached_property
    def volume(self) -> Rank1:
        """The rank-1 factors of the motion volume."""
        return decompose(self.active)

    @cached_property
    def channels(self) -> FloatArray:
        """(a, 26) the channels of the motion symbol."""
        return self.channels_of_track if self.is_whole else symbol_features(self.active)

    @cached_property
    def channels_of_track(self) -> FloatArray:
        """(n, 26) the channels of the whole track."""
        return symbol_features(self.track)

    @cached_property
    def sign_series(self) -> SignSeries:
        """The numbers of the frames from which signs of movement are made."""
        return SignSeries(self.track)

    @property
    def movement_signs(self) -> FloatArray:
        """(44,) the signs of the active part."""
        first, stop = self.span
        return np.asarray(signs_of_parts(self.sign_series, np.array([first]), stop - first)[0])

    @cached_property
    def symbol(self) -> dict[str, FloatArray]:
        """The arrays of the motion symbol by name."""
        return describe_symbol(self.channels)

    @cached_property
    def cycles(self) -> list[tuple[float, float]]:
        """The gait cycles: start and end in frames of the active part."""
        return exact_gait_cycles(self.active)

    @cached_property
    def windows(self) -> dict[str, FloatArray]:
        """The window arrays by name."""
        return window_arrays(self.features_10hz)


_FLOAT32: dict[str, Callable[[_Parts], FloatArray]] = {
    "role_positions": lambda parts: parts.track.positions,
    "features_10hz": lambda parts: parts.features_10hz,
    "active_span": lambda parts: np.array(parts.span) / parts.track.rate,
    "motion_vector": lambda parts: narrow(parts.described),
    "paced_vector": lambda parts: parts.paced_vector,
    "wide_motion_vector": lambda parts: wide(parts.described),
    "msv_lambda": lambda parts: np.array([parts.volume.weight]),
    "msv_rho": lambda parts: parts.volume.primary,
    "msv_epsilon": lambda parts: parts.volume.secondary,
    "msv_convergence": lambda parts: np.column_stack([parts.volume.errors, parts.volume.changes]),
    "motion_sample": lambda parts: motion_sample(parts.active, parts.cycles),
    "angle_sample": lambda parts: angle_sample(parts.active, parts.cycles),
    "motion_shape": lambda parts: motion_shape(parts.active, parts.cycles),
    "symbol_statistics": lambda parts: symbol_statistics(parts.channels, parts.track.rate),
    "movement_signs": lambda parts: parts.movement_signs,
}
"""How each array that is stored as float32 is computed."""
_WINDOWS = tuple(name for scale in WINDOW_SCALES for name in (scale.vectors, scale.spans))


def _for_search(parts: _Parts, names: Collection[str] | None = None) -> dict[str, FloatArray]:
    return {
        name: _array(parts, name)
        for name in (names if names is not None else (*_FLOAT32, *_WINDOWS))
    }


def _array(parts: _Parts, name: str) -> FloatArray:
    if name in _WINDOWS:
        return parts.windows[name]
    if name in SYMBOL_ARRAYS:
        return parts.symbol[name]
    return _FLOAT32[name](parts).astype(np.float32)
