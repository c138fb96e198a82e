"""Seconds of motion that are analyzed in one CPU second: from a file to all stored arrays.

Run: OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 pytest -m bench -s tests/bench/test_analysis_speed.py
It uses every third real clip, without processes or a store. test_import.py measures the product.
"""

from __future__ import annotations

import time

import pytest

from app.analysis.analyze import analyze
from app.errors import BadContent
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from tests.bench.page import Section
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "analysis_speed",
    "Motion analyzed in one CPU second",
    trials="every third real clip, in rounds that take turns; the best round counts",
)

pytestmark = pytest.mark.bench

ROUNDS = 3
MIN_SPEED = 100.0
"""Seconds of motion per second of a core (issue 2)."""


def test_seconds_of_motion_per_cpu_second() -> None:
    files = [
        ((real_clips() / row["path"]).read_bytes(), float(row["fps"])) for row in manifest()[::3]
    ]
    _speed(files[:1], stored=True)  # loads hmmlearn
    speeds = [_speed(files, stored=True) for _ in range(ROUNDS)]
    reading = [_speed(files, stored=False) for _ in range(ROUNDS)]
    FIGURES.print(f"\n{len(files)} files, best of {ROUNDS} rounds, seconds of motion a CPU second:")
    FIGURES.print(f"  read and analyzed {max(speeds):.0f}, read only {max(reading):.0f}")
    assert max(speeds) >= MIN_SPEED


def _speed(files: list[tuple[bytes, float]], *, stored: bool) -> float:
    began, seconds = time.process_time(), 0.0
    for content, rate in files:
        try:
            motion = canonicalize(read_recording(content), frame_rate=rate)
        except BadContent:
            continue
        seconds += motion.duration
        if stored:
            analyze(motion)
    return seconds / (time.process_time() - began)
