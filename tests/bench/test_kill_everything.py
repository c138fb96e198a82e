"""30 times SIGKILL of a process of `kinedex serve`, during uploads and an import.

Run: pytest -m bench -s tests/bench/test_kill_everything.py
The victim is an analysis process, the worker, the API, or a fork server of either. In the end every
acknowledged clip must exist and be ready.
"""

from __future__ import annotations

import hashlib
import os
import random
import threading
import time
import zipfile
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
import psutil
import pytest

from app.demo import DemoClip, demo_clips
from tests.bench.page import Section
from tests.bench.processes import child_running
from tests.bench.product import API, WORKER, Product, serving
from tests.busy_processes import busy_children, repeated, server_of
from tests.live import wait_until

FIGURES = Section(
    "kill_everything",
    "Thirty kills of everything that `kinedex serve` runs",
    trials="30 SIGKILLs of analysis processes, fork servers, worker and API, under uploads, an "
    "import and searches",
)

pytestmark = pytest.mark.bench

VICTIMS = {
    "worker's child": 10,
    "worker": 5,
    "worker's forkserver": 5,
    "api": 4,
    "api's forkserver": 3,
    "api's child": 3,
}
"""Number of kills of each kind of process. Their order is random."""
SEED = 22
PAUSE_S = (0.2, 1.5)
"""Shortest and longest pause between two kills, seconds."""
TIMES = 40
"""Repetitions of the motion in a clip, so that an analysis is long enough to be killed."""
EACH = 25
"""Number of uploaded clips, and number of imported clips."""
VICTIM_S = 8.0
"""How long a kill waits for its victim: an idle service has no analysis process."""
SETTLE_S = 600.0
STUCK_S = 120.0
"""If no clip ends in this time, the remaining clips are stuck."""


@dataclass
class Tally:
    """Kills, acknowledged clips, refused uploads, and statuses of searches."""

    killed: Counter[str] = field(default_factory=Counter)
    acknowledged: dict[str, str] = field(default_factory=dict)
    """SHA-256 of content, by the id of its clip."""
    refused: Counter[str] = field(default_factory=Counter)
    searches: Counter[int] = field(default_factory=Counter)


def _found(product: Product, name: str) -> psutil.Process | None:
    """A running process of that kind, or None. A child must be working."""
    owner, _, part = name.partition("'s ")
    process = child_running(product.supervisor, API if owner == "api" else WORKER)
    if process is None or not part:
        return process
    if part == "forkserver":
        return server_of(process)
    return next(iter(busy_children(process, 0.05)), None)


def _kill_one(product: Product, tally: Tally, name: str) -> None:
    def is_killed() -> bool:
        if not product.supervisor.is_running():
            return True
        victim = _found(product, name)
        with suppress(psutil.Error):
            if victim is not None:
                victim.kill()
                tally.killed[name] += 1
                return True
        return False

    try:
        wait_until(is_killed, VICTIM_S)
    except TimeoutError:
        tally.killed[f"no {name} found"] += 1


def _upload_all(product: Product, clips: list[tuple[str, bytes]], tally: Tally) -> None:
    """Upload each clip until it is acknowledged, as a client does after a broken connection."""
    with product.client() as client:
        for path, content in clips:
            while True:
                try:
                    answer = client.post("/v1/clips", files={"file": (path, content)})
                except httpx2.TransportError:
                    tally.refused["connection"] += 1
                    time.sleep(0.2)
                    continue
                if answer.status_code in (200, 202):
                    clip = answer.json()["clip"]
                    tally.acknowledged[clip["id"]] = hashlib.sha256(content).hexdigest()
                    break
                tally.refused[str(answer.status_code)] += 1
                time.sleep(0.2)


def _search_on_and_on(product: Product, content: bytes, tally: Tally, stop: Any) -> None:
    with product.client() as client:
        while not stop.wait(0.1):
            with suppress(httpx2.TransportError):
                files = {"file": ("query.bvh", content)}
                tally.searches[client.post("/v1/search/motion", files=files).status_code] += 1


def _archive(path: Path, clips: list[tuple[str, bytes]]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in clips:
            archive.writestr(name, content)
    return path


def _sent(clips: list[DemoClip], times: int) -> list[tuple[str, bytes]]:
    return [(clip.path, repeated(clip, times)) for clip in clips]


def _start_import(product: Product, archive: Path) -> str:
    job: str = wait_until(lambda: _unless_broken(lambda: product.start_import(archive)), SETTLE_S)
    return job


def _unless_broken(ask: Callable[[], Any]) -> Any:
    with suppress(httpx2.TransportError, httpx2.HTTPStatusError):
        return ask()
    return None


def _settle(product: Product) -> bool:
    """Wait until every clip and job has ended. Returns False if nothing changes any more."""
    seen, since = -1, time.monotonic()
    while time.monotonic() - since < STUCK_S:
        clips = _unless_broken(lambda: product.items("/v1/clips"))
        jobs = _unless_broken(lambda: product.items("/v1/jobs"))
        if clips is not None and jobs is not None:
            left = [c for c in clips if c["state"] not in ("ready", "failed")]
            left += [j for j in jobs if j["state"] in ("queued", "processing")]
            if not left:
                return True
            if len(left) != seen:
                seen, since = len(left), time.monotonic()
        if not product.supervisor.is_running():
            return False
        time.sleep(0.5)
    return False


def test_no_acknowledged_clip_is_lost_failed_or_stuck(tmp_path: Path) -> None:
    made = list(demo_clips(takes=2))[: 2 * EACH]
    query, uploaded, imported = made[0].content, made[:EACH], made[EACH:]
    tally, draw, stop = Tally(), random.Random(SEED), threading.Event()
    archive = _archive(tmp_path / "clips.zip", _sent(imported, TIMES))
    began = time.monotonic()
    settings = {"log_level": "warning", "job_lease_s": 5, "job_heartbeat_s": 1, "refit_growth": 99}
    with serving(tmp_path / "data", **settings) as product:
        job = _start_import(product, archive)
        uploads = threading.Thread(
            target=_upload_all, args=(product, _sent(uploaded, TIMES), tally), daemon=True
        )
        searches = threading.Thread(
            target=_search_on_and_on, args=(product, query, tally, stop), daemon=True
        )
        uploads.start()
        searches.start()
        order = [name for name, times in VICTIMS.items() for _ in range(times)]
        draw.shuffle(order)
        for name in order:
            time.sleep(draw.uniform(*PAUSE_S))
            _kill_one(product, tally, name)
        survived = product.supervisor.is_running()
        uploads.join(SETTLE_S if survived else 1.0)
        has_settled = survived and _settle(product)
        stop.set()
        clips = _unless_broken(lambda: product.items("/v1/clips")) or []
        end = _unless_broken(lambda: product.get(f"/v1/jobs/{job}")) or {}
    _print(tally, clips, end, survived, has_settled, time.monotonic() - began)
    found = {clip["id"]: clip for clip in clips}
    assert survived
    assert has_settled
    assert end["state"] == "succeeded"
    assert tally.acknowledged.keys() <= found.keys()
    assert {found[i]["sha256"] for i in tally.acknowledged} == set(tally.acknowledged.values())
    assert len(found) == len(uploaded) + len(imported)
    assert Counter(clip["state"] for clip in clips) == {"ready": len(found)}
    assert set(tally.searches) <= {200, 503}


def _print(
    tally: Tally,
    clips: list[dict[str, Any]],
    end: dict[str, Any],
    survived: bool,
    has_settled: bool,
    seconds: float,
) -> None:
    found = {clip["id"] for clip in clips}
    states = Counter(clip["state"] for clip in clips)
    why = Counter(clip["error"]["code"] for clip in clips if clip["error"])
    FIGURES.print(
        f"\n{sum(tally.killed.values())} kills in {seconds:.0f} s, load {os.getloadavg()[0]:.1f}"
    )
    FIGURES.print(f"  killed: {dict(tally.killed)}")
    FIGURES.print(
        f"  serve lives: {survived}; all settled: {has_settled}; import: {end.get('state')}"
    )
    FIGURES.print(
        f"  uploads acknowledged {len(tally.acknowledged)}, lost "
        f"{len(tally.acknowledged.keys() - found)}; clips {dict(states)}, failed for {dict(why)}"
    )
    FIGURES.print(f"  refused uploads {dict(tally.refused)}; searches {dict(tally.searches)}")
