"""Quality of the beats of recordings, of the tempo of motions, and of the offset between both.

Run: pytest -m bench -s tests/bench/test_beats.py

Generated pieces and dances of `app.demo.dances` with new seeds: weights and thresholds were fitted
on seeds below 10,000 (pieces: 500,000 to 502,000). Half of the pieces change their tempo. The
weights for recordings were fitted on other pieces of the same styles. The styles of
`tests.held_out_music` were used for no fit of them, and their figures are printed separately. Which
of the beats that are heard are danced is judged by `test_danced_music`.
"""

from __future__ import annotations

import time
from collections import defaultdict
from functools import lru_cache

import numpy as np
import pytest

from app.analysis.energy.energy import energies
from app.analysis.rhythm.audio_beats import find_audio_beats
from app.analysis.rhythm.beats import find_beats
from app.analysis.rhythm.onsets import find_onsets
from app.analysis.rhythm.rhythm import find_rhythm
from app.demo import DemoClip
from app.demo.dances import Sound, dance
from app.demo.dances.music import STYLES
from app.demo.dances.sounds import SAMPLE_RATE
from app.formats.audio.reader import read_audio
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import BodyTrack, body_track
from tests.bench.page import Section
from tests.held_out_music import HELD_OUT_STYLES
from tests.recordings import CLICKS, WITHOUT_BEAT, f_score, piece, without_beat

FIGURES = Section(
    "beats",
    "Beats of recordings, tempo from motion, and where a recording begins",
    trials="generated pieces and dances with new seeds; each line says how many",
)

pytestmark = pytest.mark.bench

TEMPI = (60, 70, 80, 90, 100, 110, 120, 130, 140)
NOISES = (0, 5, 10, 25)
"""Millimetres."""

PIECES, DANCES, OFFSETS = 90_000, 91_000, 92_000
"""First seeds."""


@lru_cache
def pieces(kind: str) -> tuple[tuple[int, np.ndarray, np.ndarray], ...]:
    """(tempo, samples, beats): two of each tempo. The tempo of the second one drifts by 5 %."""
    first = PIECES + 100 * [CLICKS, *STYLES, *HELD_OUT_STYLES].index(kind)
    return tuple(
        (bpm, *piece(first + 2 * i + half, kind, bpm, drift=0.05 * half))
        for i, bpm in enumerate(TEMPI)
        for half in (0, 1)
    )


def test_beats_of_recordings() -> None:
    means = _mean_scores((CLICKS, *STYLES))
    music = float(np.mean([means[style] for style in STYLES]))
    FIGURES.print(f"music {music:.3f}")
    assert means[CLICKS] >= 0.98
    assert music >= 0.85


def test_beats_of_styles_never_heard() -> None:
    """These styles were used for no fit, and they have no target."""
    FIGURES.print(
        f"music never heard {np.mean(list(_mean_scores(tuple(HELD_OUT_STYLES)).values())):.3f}"
    )


def _mean_scores(kinds: tuple[str, ...]) -> dict[str, float]:
    """Return the mean F by kind of piece. Prints F by tempo, and the share of right tempi."""
    FIGURES.print(
        "\nF at 70 ms of beats in recordings of 30 s; tempo within 4 %, and half or double it"
    )
    FIGURES.print(f"{'':11}" + "".join(f"{bpm:>6}" for bpm in TEMPI) + "  mean tempo octave")
    means, seconds = {}, []
    for kind in kinds:
        scores, ratios = defaultdict(list), []
        for bpm, samples, beats in pieces(kind):
            began = time.perf_counter()
            found = find_audio_beats(find_onsets(samples, SAMPLE_RATE))
            seconds.append(time.perf_counter() - began)
            scores[bpm].append(f_score(found.times, beats))
            ratios.append((found.tempo or 1.0) * float(np.median(np.diff(beats))) / 60)
        means[kind] = float(np.mean([score for both in scores.values() for score in both]))
        row = "".join(f"{np.mean(scores[bpm]):6.2f}" for bpm in TEMPI)
        right, octave = (_near(ratios, factors) for factors in ((1.0,), (0.5, 2.0)))
        FIGURES.print(f"{kind:11}{row}{means[kind]:6.3f}{right:6.2f}{octave:7.2f}")
    FIGURES.print(f"{np.median(seconds):.2f} s each")
    return means


def _near(ratios: list[float], factors: tuple[float, ...]) -> float:
    return float(np.mean([any(abs(r / w - 1) < 0.04 for w in factors) for r in ratios]))


def test_the_peer_on_the_same_recordings() -> None:
    librosa = pytest.importorskip("librosa")
    scores = defaultdict(list)
    for kind in (CLICKS, *STYLES, *HELD_OUT_STYLES):
        for _, samples, beats in pieces(kind):
            heard = samples.astype(np.float32)
            _, found = librosa.beat.beat_track(y=heard, sr=SAMPLE_RATE, units="time")
            scores[kind].append(f_score(found, beats))
    known, unheard = (
        np.mean([np.mean(scores[s]) for s in some]) for some in (STYLES, HELD_OUT_STYLES)
    )
    clicks = np.mean(scores[CLICKS])
    FIGURES.print(
        f"\nlibrosa's beat_track with its defaults: clicks {clicks:.3f}, music {known:.3f},"
        f" unheard {unheard:.3f}"
    )


def test_recordings_without_a_beat() -> None:
    FIGURES.print("\nbeats found where there are none, of 10 recordings")
    for seconds in (12.0, 30.0):
        row = {
            kind: sum(_hears(without_beat(PIECES + seed, kind, seconds)) for seed in range(10))
            for kind in WITHOUT_BEAT
        }
        FIGURES.print(
            f"{seconds:.0f} s: " + ", ".join(f"{kind} {count}" for kind, count in row.items())
        )
        assert sum(row.values()) <= 0.1 * 10 * len(row)


def _hears(samples: np.ndarray) -> bool:
    return find_audio_beats(find_onsets(samples, SAMPLE_RATE)).tempo is not None


def _energy(clip: DemoClip) -> np.ndarray:
    return energies(_track(clip)).global_energy


def _track(clip: DemoClip) -> BodyTrack:
    return body_track(canonicalize(read_recording(clip.content)))


def test_tempo_from_motion() -> None:
    """The same 36 dances with each level of noise."""
    FIGURES.print("\ntempo of dances from their motion, within 3 %; F of beats at 100 ms")
    every = []
    for noise in NOISES:
        right, silent, scores = [], 0, []
        for i in range(36):
            drift = (0.0, 0.03, 0.05)[i % 3]
            clip = dance(DANCES + i, bpm=TEMPI[i % 9] + i % 4, noise_mm=noise, drift=drift)
            found, beats = find_beats(_energy(clip), 30.0), np.array(clip.beats)
            true = 60 / float(np.median(np.diff(beats)))
            silent += found.tempo is None
            right.append(found.tempo is not None and abs(found.tempo / true - 1) < 0.03)
            scores.append(f_score(found.times, beats, within=0.1))
        every += right
        shown = f"{sum(right)} of {len(right)} right, {silent} none, F {np.mean(scores):.3f}"
        FIGURES.print(f"{noise:>3} mm: {shown}")
    FIGURES.print(f"all: {np.mean(every):.3f}")
    assert np.mean(every) >= 0.95


def test_offsets_of_recordings() -> None:
    FIGURES.print("\noffsets planted between recording and motion, -5 to 1 s")
    for sound in Sound:
        whole, modulo, unknown = [], [], 0
        for i in range(36):
            bpm, noise = TEMPI[i % 9] + i % 4, float(NOISES[i % 3])
            clip = dance(OFFSETS + i, bpm=bpm, noise_mm=noise, drift=0.03 * (i % 2), sound=sound)
            heard = read_audio(clip.audio)
            onsets = find_onsets(heard.samples, heard.rate)
            found = find_rhythm(_track(clip), onsets=onsets).offset
            if found is None or clip.audio_offset is None:
                unknown += 1
                continue
            error, beat = found.seconds - clip.audio_offset, float(np.median(np.diff(clip.beats)))
            whole.append(abs(error))
            modulo.append(abs((error + beat / 2) % beat - beat / 2))
        exact, but_for_beats = (float(np.mean(np.array(e) <= 0.05)) for e in (whole, modulo))
        quartiles = 1000 * np.percentile(modulo, [50, 75, 95])
        FIGURES.print(
            f"{sound.value}: within 50 ms {exact:.2f}; but for whole beats {but_for_beats:.2f}"
            f" (median, 75 %, 95 %: {', '.join(f'{q:.0f}' for q in quartiles)} ms);"
            f" unknown {unknown} of 36"
        )
        assert but_for_beats >= 0.85
