"""Pieces of real clips hidden in long motion: are they found, with which bounds, and how fast?

Run: pytest -m bench -s tests/bench/test_windows.py
Every second clip of the manifest belongs to one half. The weight of `fused` is chosen with pieces
of one half, in streams of that half. The report hides pieces of the other half in an hour of
motion from all clips without a piece (`hidden_pieces`). A hit is relevant if it is the first that
overlaps one of the piece's five spans (intersection at least half of the union). All other hits
count as wrong, also other takes of the same task. The second figure searches for these: the query
is a whole take in a stream, and the other takes of the same task by the same person are relevant.
"""

from __future__ import annotations

import io
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from app.analysis.analyze import analyze
from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.analysis.descriptors.motion_vector import motion_vector
from app.analysis.descriptors.windows import (
    WINDOW_SCALES,
    RunningSums,
    WindowScale,
    window_arrays,
    window_frames,
)
from app.config import Settings
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray, IntArray
from app.search.windows import in_windows
from app.search.windows.overlap_merging import Candidates, merge_overlapping
from app.services.find import find
from app.services.find.hits import Hit
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from tests.bench.hidden_pieces import (
    COPIES,
    LENGTHS,
    PIECES,
    RATE,
    Hidden,
    Span,
    Take,
    hide,
    real_takes,
)
from tests.bench.page import Section
from tests.bodies import motion_of
from tests.streams import npz_of

FIGURES = Section(
    "windows",
    "Pieces hidden in an hour of motion",
    trials="200 pieces, each hidden at five spans",
)

pytestmark = pytest.mark.bench

METHODS = ("fused", "dtw", "vector")
WEIGHTS = (0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
FLOORS = {"fused": 0.95, "dtw": 0.95, "vector": 0.55}
"""AP@5. Vectors of windows alone only propose spans: .596 at commit 058f46b and since."""
FEW, FLOOR_OF_FEW = 25, 0.85
"""Spans that `fused` compares by time warping: a 20th of the usual number."""


@pytest.fixture(scope="module")
def real() -> list[Take]:
    return real_takes()


@pytest.fixture(scope="module")
def chosen(real: list[Take], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hidden]:
    half = real[::2]
    yield from _opened(tmp_path_factory.mktemp("chosen"), half, half, seed=7)


@pytest.fixture(scope="module")
def reported(real: list[Take], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hidden]:
    yield from _opened(tmp_path_factory.mktemp("reported"), real[1::2], real, seed=8)


def _opened(folder: Path, sources: list[Take], filling: list[Take], seed: int) -> Iterator[Hidden]:
    lib = Library.open(Settings(data_dir=folder / "data", refit_growth=1e9))
    yield hide(lib, sources, filling, np.random.default_rng(seed))
    lib.close()


@dataclass(frozen=True)
class Figures:
    """AP@5 by query, boundary errors in seconds, milliseconds of each search."""

    average: FloatArray
    errors: FloatArray
    took: FloatArray

    def as_text(self) -> str:
        median, ninth = np.quantile(self.errors, [0.5, 0.9])
        half, most = np.quantile(self.took, [0.5, 0.95])
        return f"{self.average.mean():8.3f}{median:9.3f}{ninth:9.3f}{half:9.1f}{most:9.1f}"


HEAD = f"{'':10}{'AP@5':>8}{'median':>9}{'90 %':>9}{'p50 ms':>9}{'p95 ms':>9}"


def _of_pieces(hidden: Hidden, method: str) -> Figures:
    averages, errors, took = [], [], []
    for piece, truth in zip(hidden.pieces, hidden.spans, strict=True):
        content = io.BytesIO(npz_of(piece, RATE))
        asked = MotionQuery(QuerySource(content=content), method=method, scope="windows", limit=20)
        hits = find.find_motion(hidden.lib, asked)
        average, apart = _judged(_spans(hits.items), truth)
        averages.append(average)
        errors += apart
    for spans in hidden.spans:
        clip_id, start, end = spans[0]
        asked = MotionQuery(
            QuerySource(clip_id, start=start, end=end), method=method, scope="windows"
        )
        took.append(find.find_motion(hidden.lib, asked).took_ms)
    return Figures(np.array(averages), np.array(errors), np.array(took))


def _of_takes(hidden: Hidden, method: str) -> float:
    averages = []
    for spans in hidden.takes.values():
        for clip_id, start, end in spans:
            truth = [span for span in spans if span != (clip_id, start, end)]
            if truth and 0.8 <= end - start <= 10.0:
                asked = MotionQuery(
                    QuerySource(clip_id, start=start, end=end),
                    method=method,
                    scope="windows",
                    limit=20,
                )
                hits = find.find_motion(hidden.lib, asked).items
                averages.append(_judged(_spans(hits), truth, least=0.4)[0])
    return float(np.mean(averages))


def _spans(hits: tuple[Hit, ...]) -> list[Span]:
    return [(hit.clip.id, hit.start, hit.end) for hit in hits]


def _judged(hits: list[Span], truth: list[Span], least: float = 0.5) -> tuple[float, list[float]]:
    """AP@5, and the errors of both ends of every span that was found, seconds."""
    left = list(truth)
    found: list[bool] = []
    errors: list[float] = []
    for hit in hits:
        match = next((span for span in left if _overlap(hit, span) >= least), None)
        found.append(match is not None)
        if match is not None:
            left.remove(match)
            errors += [abs(hit[1] - match[1]), abs(hit[2] - match[2])]
    row = np.array(found[:5], dtype=float)
    precision = np.cumsum(row) / np.arange(1, len(row) + 1)
    return float((row * precision).sum() / min(5, len(truth))), errors


def _overlap(one: Span, other: Span) -> float:
    """Intersection over union; 0 in another clip."""
    shared = min(one[2], other[2]) - max(one[1], other[1])
    if one[0] != other[0] or shared <= 0:
        return 0.0
    return shared / (one[2] - one[1] + other[2] - other[1] - shared)


def test_pieces_hidden_in_an_hour_are_found_and_bounded(
    reported: Hidden, monkeypatch: pytest.MonkeyPatch
) -> None:
    hours = reported.seconds / 3600
    assert hours > 1
    FIGURES.print(
        f"\n{PIECES} pieces of 0.6 to 10 s, each {COPIES} times in {hours:.2f} h; ", end=""
    )
    FIGURES.print(f"load {os.getloadavg()[0]:.1f}\n{HEAD}{'takes':>9}")
    found = {}
    for method in METHODS:
        _of_pieces(reported, method)  # the first search also loads arrays, so it is not measured
        found[method] = _of_pieces(reported, method)
        FIGURES.print(f"{method:10}{found[method].as_text()}{_of_takes(reported, method):9.3f}")
    seconds = np.array([len(piece) / RATE for piece in reported.pieces])
    FIGURES.print("AP@5 of fused by seconds: ", end="")
    for length in LENGTHS:
        FIGURES.print(
            f" {length:g}: {found['fused'].average[seconds == length].mean():.2f}", end=""
        )
    monkeypatch.setattr(in_windows, "MAX_PROPOSED", FEW)
    monkeypatch.setattr(in_windows, "MIN_PROPOSED", FEW)
    few = _of_pieces(reported, "fused")
    FIGURES.print(f"\n{FEW} spans only:{few.as_text()[:8]}, as where the hour is one of 20", end="")
    kept = sum(index.state[1].nbytes for index in reported.lib.windows.values())
    FIGURES.print(f"\nwindows in memory: {kept / hours / 2**20:.1f} MB an hour")
    assert few.average.mean() >= FLOOR_OF_FEW
    for method, floor in FLOORS.items():
        assert found[method].average.mean() >= floor
    for method in ("fused", "dtw"):
        assert np.median(found[method].errors) <= 0.05
        assert np.quantile(found[method].errors, 0.9) <= 0.1


def test_the_weight_of_fused_is_the_best_on_other_clips(
    chosen: Hidden, monkeypatch: pytest.MonkeyPatch
) -> None:
    used = in_windows.VECTOR_WEIGHT
    FIGURES.print(f"\nfused by weight of the windows, {chosen.seconds / 60:.0f} minutes")
    FIGURES.print(f"{HEAD}{'takes':>9}")
    by_weight = {}
    for weight in WEIGHTS:
        monkeypatch.setattr(in_windows, "VECTOR_WEIGHT", weight)
        figures, takes = _of_pieces(chosen, "fused"), _of_takes(chosen, "fused")
        FIGURES.print(f"{weight:<10}{figures.as_text()}{takes:9.3f}")
        by_weight[weight] = figures.average.mean() + takes
    assert by_weight[used] > max(by_weight.values()) - 0.01


def test_the_light_vectors_rank_a_little_worse_than_motion_vectors(chosen: Hidden) -> None:
    """Both describe the same windows of 2 s, and pieces of a similar length."""
    pieces = [n for n, piece in enumerate(chosen.pieces) if 1.5 <= len(piece) / RATE <= 3.0]
    found = {}
    FIGURES.print(f"\n{len(pieces)} pieces of 1.5 to 3 s by windows of 2 s alone")
    for name, describe in {"light": _light, "motion": _heavy}.items():
        began = time.process_time()
        windows = [describe(stream, SCALE) for stream in chosen.streams.values()]
        spent = 1e3 * (time.process_time() - began) / chosen.seconds
        averages = [_ranked(chosen, number, windows, describe) for number in pieces]
        found[name] = float(np.mean(averages))
        FIGURES.print(
            f"{name:10}AP@5 {found[name]:.3f}   {spent:.2f} ms a second of motion, features too"
        )
    assert found["light"] > found["motion"] - 0.12


SCALE = WINDOW_SCALES[1]
Windows = tuple[IntArray, FloatArray]
"""(w, 2) frames at 10 Hz, and (w, d) vectors."""
Describe = Callable[[FloatArray, WindowScale | None], Windows]


def _light(body: FloatArray, scale: WindowScale | None) -> Windows:
    track = body_track(motion_of(body))
    features = features_at_10hz(frame_features(track), track.rate)
    frames = _frames(len(features), scale)
    return frames, RunningSums(features).vectors(frames).astype(float)


def _heavy(body: FloatArray, scale: WindowScale | None) -> Windows:
    features = frame_features(body_track(motion_of(body)))
    frames = _frames((len(features) - 1) // 3 + 1, scale)
    return frames, np.stack([motion_vector(features[3 * a : 3 * b]) for a, b in frames])


def _frames(count: int, scale: WindowScale | None) -> IntArray:
    return np.array([[0, count]]) if scale is None else window_frames(count, scale)


def _ranked(hidden: Hidden, number: int, windows: list[Windows], describe: Describe) -> float:
    """AP@5 of a piece by the distance of its vector to those of all windows."""
    piece = hidden.pieces[number]
    _, query = describe(piece, None)
    middles = np.concatenate([frames.mean(axis=1) / 10 for frames, _ in windows])
    found = Candidates(
        ids=np.array(list(hidden.streams), dtype=object),
        owners=np.repeat(np.arange(len(windows)), [len(frames) for frames, _ in windows]),
        starts=middles - len(piece) / RATE / 2,
        ends=middles + len(piece) / RATE / 2,
        distances=np.linalg.norm(np.concatenate([v for _, v in windows]) - query, axis=1),
    )
    hits = [(place.clip_id, place.start, place.end) for place in merge_overlapping(found, 5)[0]]
    return _judged(hits, hidden.spans[number])[0]


def test_what_windows_add_to_an_analysis(chosen: Hidden) -> None:
    """The share of the window arrays in an analysis, without reading the file."""
    took = {"windows": 0.0, "analysis": 0.0}
    for stream in chosen.streams.values():
        began = time.process_time()
        analysis = analyze(motion_of(stream))
        took["analysis"] += time.process_time() - began
        began = time.process_time()
        window_arrays(analysis.arrays["features_10hz"])
        took["windows"] += time.process_time() - began
    share = took["windows"] / took["analysis"]
    each = 1e3 * took["windows"] / chosen.seconds
    FIGURES.print(f"\nwindows: {each:.3f} ms a second of motion, {share:.1%} of an analysis")
    assert share < 0.05
