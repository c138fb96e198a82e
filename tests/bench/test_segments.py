"""Segments and cycles of real clips, and of generated dances that were used for no choice.

Run: pytest -m bench -s tests/bench/test_segments.py
The weights of segment vectors were chosen on every second real clip (by name), the concordance of
cycles on generated dances of seeds below 200. The figures are measured on the others.
"""

from __future__ import annotations

import time
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.analysis.descriptors.motion_vector import motion_vector
from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.segments.cycles import find_cycles
from app.analysis.segments.segments import describe_segments, segment_spans, segment_vectors
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import BodyTrack, body_track
from app.motion.frame.gait import gait_cycles
from app.numerics.arrays import FloatArray
from tests.bench.page import Section
from tests.bodies import motion_of
from tests.cyclic_dances import cyclic_dance
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "segments",
    "Segments and cycles",
    trials="segments of every second real clip, and generated dances; each line says how many",
)

pytestmark = pytest.mark.bench

MAX_SEGMENTS_PER_CLIP = 8
"""Segments of a clip that are queries, so that long clips do not dominate."""
FIRST_SEED = 1000
DANCES = 40


@lru_cache(maxsize=600)
def _track(path: str, fps: str) -> BodyTrack:
    """fps: from the manifest, because some files declare a wrong one."""
    recording = read_recording((real_clips() / path).read_bytes())
    return body_track(canonicalize(recording, frame_rate=float(fps) if fps else None))


def _rows() -> list[dict[str, str]]:
    rows = [row for row in manifest() if not row["path"].endswith((".amc", ".asf"))]
    return sorted(rows, key=lambda row: Path(row["path"]).stem)


def test_segments_find_segments_of_their_task() -> None:
    """1-NN among the segments of other clips, by segment vector and by motion vector."""
    vectors: dict[str, list[FloatArray]] = {"segment vector": [], "motion vector": []}
    tasks, owners = [], []
    for number, row in enumerate(_rows()[::2]):
        track = _track(row["path"], row["fps"])
        features = frame_features(track)
        spans = segment_spans(find_keyposes(track).times)[:MAX_SEGMENTS_PER_CLIP]
        found = segment_vectors(features_at_10hz(features, track.rate), spans)
        vectors["segment vector"] += list(found.astype(np.float16).astype(float))
        for first, stop in np.round(spans * track.rate).astype(int):
            vectors["motion vector"].append(motion_vector(features[first : max(stop, first + 2)]))
        tasks += [row["task"]] * len(spans)
        owners += [number] * len(spans)
    labels, clips = np.array(tasks), np.array(owners)
    FIGURES.print(f"\n{len(labels)} segments of {len(set(owners))} clips, 1-NN by task:", end="")
    shares = {}
    for name, rows in vectors.items():
        apart = cdist(rows, rows)
        apart[clips[:, None] == clips[None]] = np.inf
        shares[name] = float(np.mean(labels[apart.argmin(axis=1)] == labels))
        FIGURES.print(f"  {name} {shares[name]:.3f}", end="")
    FIGURES.print()
    assert shares["segment vector"] > shares["motion vector"] - 0.05


def test_cycles_of_walks_are_strides() -> None:
    walks = agree = found = held = false = 0
    for row in _rows():
        track = _track(row["path"], row["fps"])
        keyposes = find_keyposes(track).frames.astype(float)
        cycles = find_cycles(track.local.reshape(track.frames, -1), keyposes)
        if row["task"].startswith("walk") and len(gait := gait_cycles(track)) > 1:
            walks += 1
            found += bool(cycles)
            stride = np.median([stop - first for first, stop in gait])
            lasts = np.median([keyposes[c.stop] - keyposes[c.first] for c in cycles] or [0.0])
            agree += abs(lasts / stride - 1) < 0.1
        if row["task"].startswith("raise-up") or row["task"] == "bow":
            held += 1
            false += bool(cycles)
    FIGURES.print(f"\n{walks} walks: cycles in {found}, as long as a stride within 10 % in {agree}")
    FIGURES.print(f"{held} clips of one gesture: cycles in {false}")
    assert found > 0.8 * walks
    assert agree > 0.8 * found
    assert false <= 0.05 * held


def test_cycles_of_generated_dances() -> None:
    """The period is right within 10 %, and dances without repetition have no cycle.

    change: how much repetitions of a pose differ, as a share of the pose's reach.
    """
    for change in (0.0, 0.15, 0.3, 0.5):
        right = false = 0
        for seed in range(FIRST_SEED, FIRST_SEED + DANCES):
            draw = np.random.default_rng(seed)
            poses, times = int(draw.integers(3, 11)), int(draw.integers(2, 6))
            tempo = float(draw.uniform(70, 130))
            dance = cyclic_dance(seed, poses=poses, times=times, tempo=tempo, change=change)
            lasting = _periods(dance.positions, dance.rate)
            period = np.median([end - start for start, end in dance.cycles])
            right += abs(lasting / period - 1) < 0.1
            other = cyclic_dance(seed + 500, poses=24, times=1, tempo=tempo, change=change)
            false += _periods(other.positions, other.rate) > 0
        FIGURES.print(
            f"\nchange {change:.2f}: period right in {right} of {DANCES}, false in {false}", end=""
        )
        assert right >= (0.95 if change < 0.5 else 0.8) * DANCES
        assert false <= 0.05 * DANCES
    FIGURES.print()


def test_the_time_of_segments_is_printed() -> None:
    dance = cyclic_dance(FIRST_SEED, poses=8, times=8, tempo=110)
    track = body_track(motion_of(dance.positions, dance.rate))
    features = features_at_10hz(frame_features(track), track.rate)
    times = find_keyposes(track).times
    began = time.process_time()
    found = describe_segments(features, times)
    spent = time.process_time() - began
    count = len(found["segment_spans"])
    FIGURES.print(f"\n{count} segments of {track.duration:.0f} s in {1000 * spent:.0f} ms")


def _periods(positions: FloatArray, rate: float) -> float:
    """Seconds of the median cycle of the longest run; 0 without cycles."""
    track = body_track(motion_of(positions, rate))
    keyposes = find_keyposes(track).frames.astype(float)
    cycles = find_cycles(track.local.reshape(track.frames, -1), keyposes)
    runs = [[c for c in cycles if c.run == run] for run in {c.run for c in cycles}]
    longest = max(runs, key=lambda run: keyposes[run[-1].stop] - keyposes[run[0].first], default=[])
    lasts = [keyposes[c.stop] - keyposes[c.first] for c in longest]
    return float(np.median(lasts) / track.rate) if lasts else 0.0
