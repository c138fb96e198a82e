"""Time of the first search of each kind after a start, and of the next ones.

Run: pytest -m bench -s tests/bench/test_first_queries.py
Each kind has its own start: the API runs as a process over the same library, is asked as soon as
`/readyz` says that it is warm, and ends. Times are printed and not asserted (target of issue 19:
.3 s for the first search). BENCH_CLIPS=500 chooses another number of clips.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from statistics import median

import httpx2
import pytest

from app.config import Settings
from app.demo import DemoClip, demo_clips
from app.store import identity
from app.store.store import Store
from tests.bench.large_library import fill
from tests.bench.page import Section
from tests.bench.worded_library import describe
from tests.live import NET_S, Live, serve, wait_until

CLIPS = int(os.environ.get("BENCH_CLIPS", "10000"))
NEXT = 10
"""Searches after the first one, each for another clip."""
FIT_S = 3600.0
ARRAYS = (
    *("paced_vector", "features_10hz", "active_span", "msv_rho", "msv_epsilon", "pose_cover"),
    *("role_positions", "segment_vectors", "segment_spans", "segment_cycles"),
)
"""Arrays that these searches read."""

FIGURES = Section(
    "first_queries",
    "The first search after a start",
    trials=f"one start for each kind of search, over {CLIPS:,} clips; {NEXT} searches after it",
)

pytestmark = pytest.mark.bench

Ask = Callable[[httpx2.Client, int], httpx2.Response]
"""Searches for the clip with a number."""


@pytest.fixture(scope="module")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A library with fitted models."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("first") / "data")
    identity.prepare(settings.database, settings.files_dir)
    store = Store.open(settings.database, settings.files_dir)
    fill(store, CLIPS, names=ARRAYS)
    describe(store, CLIPS)
    store.close()
    with serve(settings.data_dir, worker=True) as live, live.client() as client:
        job = client.post("/v1/models/fit").json()["job"]["id"]
        assert live.wait_for_job(job, FIT_S)["state"] == "succeeded"
    return settings.data_dir


@cache
def _files() -> list[DemoClip]:
    return list(demo_clips(("ada", "bruno"), ("walk", "kick"), takes=3))


def _motion(client: httpx2.Client, number: int, **asked: str) -> httpx2.Response:
    body = {"clip_id": f"clip_{number:020x}", **asked}
    return client.post("/v1/search/motion", json=body)


def _file(client: httpx2.Client, number: int) -> httpx2.Response:
    clip = _files()[number]
    return client.post("/v1/search/motion", files={"file": (clip.path, clip.content)})


KINDS: dict[str, Ask] = {
    "an uploaded file": _file,
    "a stored clip": _motion,
    "segments": lambda client, number: _motion(client, number, scope="segments"),
    "words": lambda client, _: client.post("/v1/search/words", json={"words": ["walk"]}),
    "words, cca": lambda client, _: client.post(
        "/v1/search/words", json={"words": ["walk"], "mode": "cca"}
    ),
    "pose": lambda client, number: client.post(
        "/v1/search/pose", json={"clip_id": f"clip_{number:020x}", "time": 0.5}
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_first_search(data_dir: Path, kind: str) -> None:
    began = time.perf_counter()
    with serve(data_dir) as live, live.client() as client:
        ready = time.perf_counter() - began
        wait_until(lambda: _is_warm(live), NET_S)
        warm = time.perf_counter() - began
        _files()  # to make them is no part of the first search
        times = [_seconds(client, KINDS[kind], number) for number in range(NEXT + 1)]
    FIGURES.print(
        f"{kind:18} first {1e3 * times[0]:6.0f} ms, later {1e3 * median(times[1:]):6.0f} ms"
        f" (median); ready after {ready:4.1f} s, warm after {warm:4.1f} s;"
        f" load {os.getloadavg()[0]:.1f}"
    )


def _is_warm(live: Live) -> bool:
    with live.client() as client:
        return bool(client.get("/readyz").json()["is_warm"])


def _seconds(client: httpx2.Client, ask: Ask, number: int) -> float:
    began = time.perf_counter()
    answer = ask(client, number)
    took = time.perf_counter() - began
    assert answer.status_code == 200, answer.text
    return took
