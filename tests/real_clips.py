"""The folder of real clips, for the tests that measure on them. No clip is copied."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def real_clips() -> Path:
    """The folder in KINEDEX_DATA_SET, or the one next to the clone. Skips the test without it."""
    folder = Path(os.environ.get("KINEDEX_DATA_SET") or ROOT / ".." / "shared" / "data")
    if not (folder / "manifest.csv").is_file():
        pytest.skip("REAL CLIPS ABSENT: set KINEDEX_DATA_SET to the folder with manifest.csv")
    return folder


def manifest() -> list[dict[str, str]]:
    """The rows of the real clips' manifest."""
    with (real_clips() / "manifest.csv").open(newline="") as lines:
        return list(csv.DictReader(lines))
