"""Keyposes: the poses at which a motion comes to rest on its beats (Perera 2009, section 3).

Around each beat the energy's minimum is a candidate if it is small (T1) or far below the
maximum (T2); a candidate of the global energy comes before one of the local energy.
Where the motion has no beat, every deep minimum of the energy is looked at instead.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from app.analysis.beats import Beats, find_beats
from app.analysis.energy import EnergyMethod, energies
from app.motion.body_frame import BodyTrack
from app.numerics.arrays import FloatArray, IntArray

T1 = 0.35
"""A minimum is small below this share of the median local maximum."""

T2 = 0.7
"""A minimum is deep if it lies this share of the median local maximum below the maximum."""

SEARCH = 0.5
"""How far around a beat to look, in beats."""

LONE_BEAT = 15.0
"""Frames; taken for the beat where only one is given."""

LEAST_APART = 0.2
"""Seconds between keyposes."""

RIPPLE = 0.2
"""Where there are no beats, a minimum must lie this share of the median local maximum
below what is on both its sides."""


@dataclass(frozen=True, slots=True)
class Keyposes:
    """Where the keyposes are and from what they were found.

    frames: (k,) at ANALYSIS_RATE, rising; times: (k,) seconds; global_energy, local_energy:
    (n,) body lengths per second; beats: the beats used, `beats.tempo` None where none.
    """

    frames: IntArray
    times: FloatArray
    global_energy: FloatArray
    local_energy: FloatArray
    beats: Beats
    method: EnergyMethod
    t1: float
    t2: float


def find_keyposes(
    track: BodyTrack,
    *,
    method: EnergyMethod | str = EnergyMethod.RMS,
    t1: float = T1,
    t2: float = T2,
    beats: FloatArray | None = None,
) -> Keyposes:
    """The keyposes of `track`.

    beats: (b,) seconds, where they are known; otherwise estimated from the motion.
    t1, t2: thresholds in units of the median local maximum of each energy curve.
    Raises ValueError for another method.
    """
    method = EnergyMethod(method)
    curves = energies(track, method)
    if beats is None:
        found = find_beats(energies(track).global_energy, track.rate)
    else:
        found = Beats(np.asarray(beats, dtype=np.float64), _tempo(beats), 1.0)
    whole, own = curves.global_energy, curves.local_energy
    frames = (
        _on_beats(whole, own, found.times * track.rate, t1, t2)
        if len(found.times)
        else _deep_minima(whole, t1, t2)
    )
    kept = _apart(frames, whole, LEAST_APART * track.rate)
    return Keyposes(kept, kept / track.rate, whole, own, found, method, t1, t2)


def _tempo(beats: FloatArray) -> float | None:
    return float(60.0 / np.median(np.diff(beats))) if len(beats) > 1 else None


def _on_beats(
    whole: FloatArray, own: FloatArray, beats: FloatArray, t1: float, t2: float
) -> list[int]:
    """For each beat (in frames) its candidate by global, else by local energy."""
    reach = SEARCH * (float(np.median(np.diff(beats))) if len(beats) > 1 else LONE_BEAT)
    curves = [(curve, _median_maximum(curve)) for curve in (whole, own)]
    found = []
    for beat in beats:
        candidates = (_near_beat(c, beat, reach, t1 * unit, t2 * unit) for c, unit in curves)
        found += [frame for frame in candidates if frame is not None][:1]
    return found


def _median_maximum(curve: FloatArray) -> float:
    """The median local maximum of an energy curve; its maximum where it has none inside."""
    peaks, _ = find_peaks(curve)
    return float(np.median(curve[peaks])) if len(peaks) else float(curve.max())


def _near_beat(
    curve: FloatArray, beat: float, reach: float, small: float, drop: float
) -> int | None:
    """The least-energy frame around a beat, if it is small, or far below what is around it."""
    first, stop = max(0, round(beat - reach)), min(len(curve), round(beat + reach) + 1)
    if first >= stop:
        return None
    around = curve[first:stop]
    lowest = first + int(np.argmin(around))
    rests = curve[lowest] < small or around.max() - curve[lowest] > drop
    return lowest if rests and _is_minimum(curve, lowest) else None


def _is_minimum(curve: FloatArray, frame: int) -> bool:
    """Not merely the lower end of a slope that runs on outside what was looked at."""
    before, after = curve[max(frame - 1, 0)], curve[min(frame + 1, len(curve) - 1)]
    return bool(curve[frame] <= before and curve[frame] <= after)


def _deep_minima(curve: FloatArray, t1: float, t2: float) -> list[int]:
    """Minima, beats or not, that are small or deep on both sides, and no mere ripple."""
    unit = _median_maximum(curve)
    minima, found = find_peaks(-curve, prominence=RIPPLE * unit, plateau_size=1)
    deep = (curve[minima] < t1 * unit) | (found["prominences"] > t2 * unit)
    return [int(frame) for frame in minima[deep]]


def _apart(frames: list[int], curve: FloatArray, least: float) -> IntArray:
    """Rising frames at least `least` apart; of those too close the one of less energy stays."""
    kept: list[int] = []
    for frame in sorted(set(frames)):
        if kept and frame - kept[-1] < least:
            kept[-1] = min(kept[-1], frame, key=lambda f: float(curve[f]))
        else:
            kept.append(frame)
    return np.array(kept, dtype=np.int64)
