"""Every format of the real clips: files read, joint roles found, frame rates judged, time.

Run: pytest -m bench -s tests/bench/test_formats.py
The manifest's `fps` is the true frame rate. The files are read without it. The time of reading and
kinematics is compared with a numpy read of the same numbers: for text the numbers of its motion,
for binary files their bytes as float32.

The two FBX files count as wrong and not noticed, but the manifest is wrong: it gives the 120 Hz of
the recording, and the keys have 30 Hz (at 120 Hz the hands would reach 38 m/s).
"""

from __future__ import annotations

import re
import time
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from app.formats.read import read_recording
from app.formats.sniff import sniff
from app.kinedex_error import KinedexError
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from tests.bench.page import Section
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "formats",
    "Formats, joint roles and frame rates of the real clips",
    trials="all 501 motion files of the folder, each read once",
)

pytestmark = pytest.mark.bench

SUSPECT = "frame_rate_suspect"
RATE_TOLERANCE_HZ = 1.0
_NUMBER = re.compile(rb"(?<=\s)-?[0-9]+\.[0-9]+")


@dataclass
class Tally:
    """Results for the files of one format."""

    read: int = 0
    refused: list[str] = field(default_factory=list)
    missing_roles: int = 0
    wrong_rates: int = 0
    wrong_found: int = 0
    right_blamed: list[str] = field(default_factory=list)
    megabytes: float = 0.0
    seconds: float = 0.0
    numpy_seconds: float = 0.0


def test_every_format_of_the_real_clips() -> None:
    tallies: dict[str, Tally] = defaultdict(Tally)
    for row in manifest():
        path = real_clips() / row["path"]
        content = path.read_bytes()
        _judge(tallies[sniff(content)], path, content, float(row["fps"]))
    _show(tallies)
    assert not any(tally.refused or tally.right_blamed for tally in tallies.values())


def _judge(tally: Tally, path: Path, content: bytes, true_rate: float) -> None:
    tally.megabytes += len(content) / 2**20
    tally.numpy_seconds += _numpy_seconds(content)
    began = time.process_time()
    try:
        recording = read_recording(content, _companion(path))
    except KinedexError as problem:
        tally.refused.append(f"{path.name}: {problem.detail}")
        return
    tally.seconds += time.process_time() - began
    motion = canonicalize(recording)
    tally.read += 1
    tally.missing_roles += len(motion.missing_roles)
    _judge_rate(tally, path.name, motion, true_rate)


def _judge_rate(tally: Tally, name: str, motion: Motion, true_rate: float) -> None:
    is_wrong = abs(motion.frame_rate - true_rate) > RATE_TOLERANCE_HZ
    is_blamed = any(caution.code == SUSPECT for caution in motion.cautions)
    tally.wrong_rates += is_wrong
    tally.wrong_found += is_wrong and is_blamed
    if is_blamed and not is_wrong:
        tally.right_blamed.append(name)


def _companion(path: Path) -> bytes | None:
    """The ASF file of an AMC file: the stem of the AMC begins with the stem of the ASF."""
    if path.suffix != ".amc":
        return None
    return next(p for p in path.parent.glob("*.asf") if path.stem.startswith(p.stem)).read_bytes()


def _numpy_seconds(content: bytes) -> float:
    began = time.process_time()
    numbers = content.partition(b"MOTION")[2]
    if sniff(content) == "bvh":
        np.array(numbers.split()[5:], dtype=np.float64)
    elif sniff(content) == "amc":
        np.array(_NUMBER.findall(content), dtype=np.float64)
    else:
        np.frombuffer(content[: len(content) // 4 * 4], dtype=np.float32).copy()
    return time.process_time() - began


def _show(tallies: dict[str, Tally]) -> None:
    FIGURES.print()
    head = ("format", "read", "refused", "roles missing", "wrong fps", "found", "blamed")
    FIGURES.print("".join(f"{name:>14}" for name in head), "   s/MB   x numpy")
    for name, t in sorted(tallies.items()):
        cells = (name, t.read, len(t.refused), t.missing_roles, t.wrong_rates, t.wrong_found)
        FIGURES.print(
            "".join(f"{cell!s:>14}" for cell in (*cells, len(t.right_blamed))),
            f"{t.seconds / t.megabytes:7.3f} {t.seconds / t.numpy_seconds:9.1f}",
        )
        for line in (*t.refused, *t.right_blamed):
            FIGURES.print("   ", line)
