"""The tour of the API with curl (`tour.sh`) succeeds, and leaves the library as it was."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import httpx2

from tests.live import Live

TOUR = Path(__file__).with_name("tour.sh")
LABELS = "id,name,person,task,words,metadata,frame_rate"
LONGEST = 1_000
"""Characters of a line that a person still looks at."""


def _labels(demo: httpx2.Client) -> list[dict[str, Any]]:
    found = demo.get("/v1/clips", params={"limit": 1000, "fields": LABELS}).json()["items"]
    return sorted(found, key=lambda clip: str(clip["id"]))


def test_the_tour(demo_service: Live, demo: httpx2.Client) -> None:
    before = _labels(demo)
    ended = subprocess.run(
        ["bash", TOUR, demo_service.url], capture_output=True, text=True, timeout=300, check=False
    )
    assert (ended.returncode, ended.stderr) == (0, ""), ended.stdout
    assert ended.stdout.endswith("\n")
    assert max(map(len, ended.stdout.splitlines())) <= LONGEST
    assert _labels(demo) == before
