"""Random dances are deterministic and human, and the body rests or is slow at their keyposes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from app.analysis.energy.energy import EnergyMethod, energies
from app.analysis.keyposes.energy_minima import median_maximum
from app.analysis.keyposes.keyposes import T1, T2, find_candidates
from app.demo import DemoClip
from app.demo.dances import FLOWING, STOPPING, Manner, dance
from app.formats.read import read_recording
from app.models.keyposes.matching import match, total
from app.models.keyposes.thresholds import Example, curve_of_t1
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_track
from app.motion.motion import Motion

SEEDS = {0: 60.0, 1: 85.0, 2: 110.0, 3: 140.0}
"""Tempo by seed."""


@lru_cache
def made(seed: int) -> tuple[DemoClip, Motion]:
    clip = dance(seed, bpm=SEEDS[seed], seconds=16.0, drift=0.03)
    return clip, canonicalize(read_recording(clip.content))


def test_a_seed_determines_the_bytes() -> None:
    once, again, other = (dance(seed, seconds=6.0) for seed in (3, 3, 4))
    assert once == again
    assert other.content != once.content


@pytest.mark.parametrize("seed", SEEDS)
def test_a_dance_is_read_without_cautions(seed: int) -> None:
    clip, motion = made(seed)
    assert motion.cautions == ()
    assert motion.missing_roles == ()
    assert motion.duration == pytest.approx(16.0, abs=2.5)
    assert len(clip.keyposes) == len(clip.holds) >= 8


@pytest.mark.parametrize("seed", SEEDS)
def test_the_beats_have_the_requested_tempo(seed: int) -> None:
    clip, motion = made(seed)
    intervals = np.diff(clip.beats)
    nominal = 60.0 / SEEDS[seed]
    assert np.all(np.abs(intervals / nominal - 1) < 0.032)
    assert np.ptp(intervals) / nominal > 0.01  # it drifts
    assert clip.beats[0] > 0.0
    assert clip.beats[-1] < motion.duration


@pytest.mark.parametrize("seed", SEEDS)
def test_the_body_rests_at_keyposes_and_moves_between(seed: int) -> None:
    clip, motion = made(seed)
    energy = energies(body_track(motion)).global_energy
    times = np.arange(len(energy)) / 30.0
    at_keyposes = np.interp(clip.keyposes, times, energy)
    between = [
        energy[(times > leave) & (times < arrive)].max()
        for (_, leave), (arrive, _) in zip(clip.holds, clip.holds[1:], strict=False)
    ]
    assert np.median(at_keyposes) < 0.25 * np.median(between)
    assert np.median(between) > 0.4  # body lengths a second: more than swaying


@pytest.mark.parametrize("seed", SEEDS)
def test_keyposes_are_near_beats(seed: int) -> None:
    clip, _ = made(seed)
    beats = np.array(clip.beats)
    off = [np.abs(beats - keypose).min() for keypose in clip.keyposes]
    assert max(off) <= 0.04 + 1e-9
    assert all(a <= k <= b for k, (a, b) in zip(clip.keyposes, clip.holds, strict=True))


@pytest.mark.parametrize("seed", SEEDS)
def test_feet_stay_above_the_floor_and_near_the_start(seed: int) -> None:
    _, motion = made(seed)
    assert motion.positions[..., 1].min() > -0.02
    floor = motion.positions[..., [0, 2]]
    assert np.abs(floor - floor[:1].mean(axis=1, keepdims=True)).max() < 2.5


@pytest.mark.parametrize("seed", SEEDS)
def test_no_joint_is_faster_than_human_joints(seed: int) -> None:
    _, motion = made(seed)
    speeds = np.linalg.norm(np.diff(motion.positions, axis=0), axis=-1) * motion.frame_rate
    assert speeds.max() < 9.0


def test_passes_leave_beats_without_keyposes_and_freezes_hold_longer() -> None:
    every, passing, frozen = (
        dance(5, bpm=100, manner=Manner(passes=passes, freezes=freezes))
        for passes, freezes in ((0.0, 0.0), (0.8, 0.0), (0.0, 0.9))
    )
    assert len(passing.keyposes) < len(every.keyposes)
    assert max(b - a for a, b in every.holds) < 0.4
    assert np.median([b - a for a, b in frozen.holds]) > 0.55


def test_noise_has_the_requested_size() -> None:
    clip, same = (dance(6, seconds=6.0, noise_mm=mm) for mm in (10.0, 1e-6))
    noisy, clean = (read_recording(c.content).positions for c in (clip, same))
    assert np.std(noisy - clean) == pytest.approx(0.01, rel=0.02)
    assert clip.keyposes == same.keyposes


def performed(manner: Manner) -> list[tuple[DemoClip, Motion]]:
    clips = [dance(seed, bpm=bpm, seconds=16.0, manner=manner) for seed, bpm in SEEDS.items()]
    return [(clip, canonicalize(read_recording(clip.content))) for clip in clips]


def resting_share(motion: Motion) -> float:
    energy = energies(body_track(motion)).global_energy
    return float(np.mean(energy < T1 * median_maximum(energy)[0]))


def test_a_flowing_dancer_rests_less() -> None:
    flowing, stopping = (
        np.mean([resting_share(motion) for _, motion in performed(manner)])
        for manner in (FLOWING, STOPPING)
    )
    assert flowing < 0.75 * stopping


def test_a_flowing_dancer_is_slow_at_keyposes() -> None:
    for clip, motion in performed(FLOWING):
        energy = energies(body_track(motion)).global_energy
        at_keyposes = np.interp(clip.keyposes, np.arange(len(energy)) / 30.0, energy)
        assert np.median(at_keyposes) < 0.7 * np.median(energy)
        assert motion.cautions == ()
        speeds = np.linalg.norm(np.diff(motion.positions, axis=0), axis=-1) * motion.frame_rate
        assert speeds.max() < 9.0


def test_flowing_dances_tell_thresholds_and_methods_apart() -> None:
    tracks = [(body_track(motion), clip) for clip, motion in performed(FLOWING)]
    rms, printed = (
        [
            Example(
                find_candidates(track, method=method, beats=np.array(clip.beats)),
                np.array(clip.keyposes),
            )
            for track, clip in tracks
        ]
        for method in (EnergyMethod.RMS, EnergyMethod.PRINTED)
    )
    by_rms, by_printed = (
        total(match(one.candidates.times(T1, T2), one.true) for one in some)
        for some in (rms, printed)
    )
    assert by_rms.f > by_printed.f + 0.03
    recall = curve_of_t1(rms, T2).recall
    assert recall[0] < 0.6 < 0.85 < recall[-1]
    assert np.unique(recall).size > 5
