"""The service under load: searches and uploads together, while models are fitted, and too many.

Run: pytest -m bench -s tests/bench/test_load.py
The library has real clips with noise on their vectors and statistics. The API and the worker run as
processes, and an asyncio client on the same machine asks them: so client and service share its
cores. Times are printed; what is asserted holds on any machine: nothing acknowledged is lost, no
answer is a server error, too many calls are refused with a hint, and the service recovers.

BENCH_CLIPS=500 chooses another number of clips, BENCH_SECONDS another duration of
the mixed load.
"""

from __future__ import annotations

import os
import random
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import psutil
import pytest

from app.config import Settings
from app.demo import demo_clips
from app.store import identity
from app.store.store import Store
from tests.bench.driver import Outcome, Request, drive, flood
from tests.bench.large_library import fill
from tests.bench.page import Section
from tests.bench.processes import MB, processes_over
from tests.bench.worded_library import describe
from tests.live import ACTORS, ENDED, TASKS, Live, serve, wait_until

FIGURES = Section(
    "load",
    "The service under load",
    trials="each row asks for 20 s; the mixed load for the time that its line says",
)

pytestmark = pytest.mark.bench

CLIPS = int(os.environ.get("BENCH_CLIPS", "10000"))
MIXED_S = float(os.environ.get("BENCH_SECONDS", "600"))
STAGE_S = 20.0
KINDS = ("vector", "fused", "words", "pose", "upload")
SHARES = (4, 4, 4, 4, 1)
"""How often each kind is asked, relative to the others."""
WORDS = ("walk", "run", "bow", "wave", "turn")
ARRAYS = (
    "paced_vector", "features_10hz", "active_span", "msv_rho", "msv_epsilon", "pose_cover",
    "role_positions",
)  # fmt: skip
"""Arrays that these searches read."""
STREAMS, IDLE = 200, 1000
SETTLED_S = 60.0
"""Time after which the memory of the API is compared with that at the end."""
FIT_S = 3600.0


@pytest.fixture(scope="module")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    settings = Settings(data_dir=tmp_path_factory.mktemp("load") / "data")
    identity.prepare(settings.database, settings.files_dir)
    store = Store.open(settings.database, settings.files_dir)
    fill(store, CLIPS, names=ARRAYS)
    describe(store, CLIPS)
    store.close()
    return settings.data_dir


@pytest.fixture(scope="module")
def live(data_dir: Path) -> Iterator[Live]:
    connections = {"max_connections": 2000, "max_connections_per_address": 2000}
    with serve(data_dir, worker=True, **connections) as service:
        _fit(service, wait=True)
        drive(service.url, requests(), 1, 5.0)  # the first searches load arrays
        yield service


def requests(kinds: tuple[str, ...] = KINDS, seed: int = 1) -> Iterator[Request]:
    """Endless requests, drawn by SHARES."""
    rng, uploads = random.Random(seed), list(demo_clips(ACTORS, TASKS, takes=1))
    weights = [SHARES[KINDS.index(kind)] for kind in kinds]
    while True:
        (kind,) = rng.choices(kinds, weights)
        clip_id = f"clip_{rng.randrange(CLIPS):020x}"
        if kind == "upload":
            yield Request(kind, clip=rng.choice(uploads))
        elif kind == "words":
            yield Request(kind, "words", {"words": rng.sample(WORDS, 2)})
        elif kind == "pose":
            yield Request(kind, "pose", {"clip_id": clip_id, "time": 0.5})
        else:
            yield Request(kind, "motion", {"clip_id": clip_id, "method": kind})


def _fit(live: Live, *, wait: bool) -> str:
    with live.client() as client:
        job: str = client.post("/v1/models/fit").json()["job"]["id"]
    if wait:
        live.wait_for_job(job, FIT_S)
    return job


def _is_whole(live: Live, outcome: Outcome) -> None:
    """Nothing acknowledged is lost, and every answer is an answer or a refusal with a hint."""
    assert outcome.broken == 0
    assert set(outcome.statuses) <= {200, 202, 429, 503}, outcome.statuses
    assert outcome.without_hint == 0
    with live.client() as client:
        for clip_id in outcome.stored:
            assert client.get(f"/v1/clips/{clip_id}").status_code == 200, clip_id


def _show(title: str, outcome: Outcome, seconds: float) -> None:
    answered = sum(len(times) for times in outcome.seconds.values())
    FIGURES.print(
        f"{title}: {answered / seconds:.1f} answers a second, {len(outcome.refusals)} refused"
    )
    for kind in KINDS:
        FIGURES.print(f"  {kind:10}{outcome.row(kind)}   of {len(outcome.seconds[kind])}")


def test_searches_and_uploads_together(live: Live) -> None:
    FIGURES.print(f"{CLIPS} clips; milliseconds: median, p95, p99; load {os.getloadavg()[0]:.1f}")
    for clients in (1, 8, 32):
        outcome = drive(live.url, requests(seed=clients), clients, STAGE_S)
        _show(f"{clients} clients", outcome, STAGE_S)
        _is_whole(live, outcome)


def test_while_models_are_fitted(live: Live) -> None:
    searches = KINDS[:-1]
    alone = drive(live.url, requests(searches), 8, STAGE_S)
    job = _fit(live, wait=False)
    with live.client() as client:
        wait_until(lambda: client.get(f"/v1/jobs/{job}").json()["state"] == "processing", FIT_S)
        during = drive(live.url, requests(searches), 8, STAGE_S)
        still = client.get(f"/v1/jobs/{job}").json()["state"]
        client.delete(f"/v1/jobs/{job}")
        wait_until(lambda: client.get(f"/v1/jobs/{job}").json()["state"] in ENDED, FIT_S)
    _show("8 clients, searches alone", alone, STAGE_S)
    _show(f"8 clients, while models are fitted (the fit is {still} afterwards)", during, STAGE_S)
    ratios = [during.percentile(kind, 95) / alone.percentile(kind, 95) for kind in searches]
    FIGURES.print("p95 during the fit, times that without:", *(f"{ratio:.2f}" for ratio in ratios))
    _is_whole(live, during)


def test_too_many_are_refused_at_once_and_the_service_recovers(live: Live) -> None:
    outcome = flood(live.url, requests(("fused", "pose")), 200, 10.0)
    _is_whole(live, outcome)
    after = drive(live.url, requests(("fused",)), 1, 3.0)
    refused = np.percentile(outcome.refusals, [50, 95]) if outcome.refusals else [np.nan] * 2
    FIGURES.print(
        f"200 clients: {sum(map(len, outcome.seconds.values()))} answered, "
        f"{len(outcome.refusals)} refused, each with Retry-After, after {1e3 * refused[0]:.0f} ms "
        f"(p95 {1e3 * refused[1]:.0f}); a moment later one client waits "
        f"{1e3 * after.percentile('fused', 50):.0f} ms (median)"
    )
    assert after.statuses[200] > 0


def test_streams_and_idle_connections(live: Live) -> None:
    with live.client() as client, ExitStack() as opened:
        job = client.get("/v1/jobs", params={"kind": "fit", "limit": 1}).json()["items"][0]["id"]
        address = ("127.0.0.1", int(live.url.rpartition(":")[2]))
        for _ in range(IDLE):
            opened.enter_context(socket.create_connection(address))
        answers = []
        for _ in range(STREAMS):
            connection = opened.enter_context(socket.create_connection(address, timeout=30.0))
            connection.sendall(
                f"GET /v1/jobs/{job}/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode()
            )
            answers.append(connection.recv(12).decode().split()[1])
        outcome = drive(live.url, requests(("vector",)), 1, 3.0)
    FIGURES.print(
        f"{IDLE} idle connections and {STREAMS} event streams ({answers.count('200')} answered): "
        f"a vector search takes {1e3 * outcome.percentile('vector', 50):.0f} ms (median)"
    )
    assert set(answers) <= {"200", "429", "503"}
    assert outcome.broken == 0


def test_memory_does_not_grow(live: Live) -> None:
    drive(live.url, requests(seed=5), 8, min(SETTLED_S, MIXED_S / 2))
    before = _api_memory(live)
    outcome = drive(live.url, requests(seed=6), 8, MIXED_S)
    after = _api_memory(live)
    FIGURES.print(
        f"{MIXED_S:.0f} s of mixed load by 8 clients: {sum(outcome.statuses.values())} calls, "
        f"statuses {dict(outcome.statuses)}; memory of the API {before / MB:.0f} MB before, "
        f"{after / MB:.0f} MB after"
    )
    _is_whole(live, outcome)
    assert after < 1.5 * before


def _api_memory(live: Live) -> float:
    found = [p for p in processes_over(live.data_dir) if "app.api.server" in " ".join(p.cmdline())]
    return float(sum(process.memory_full_info().uss for process in found))


def test_a_stop_under_load_loses_nothing(data_dir: Path) -> None:
    with serve(data_dir) as running:
        outcomes: list[Outcome] = []
        ask = threading.Thread(
            target=lambda: outcomes.append(drive(running.url, requests(seed=7), 8, 6.0))
        )
        ask.start()
        time.sleep(3.0)
        port = running.url.rpartition(":")[2]
        (api,) = (p for p in processes_over(data_dir) if p.environ().get("KINEDEX_PORT") == port)
        began = time.perf_counter()
        api.terminate()
        psutil.wait_procs([api], timeout=60.0)
        took = time.perf_counter() - began
        ask.join()
    outcome = outcomes[0]
    with serve(data_dir) as again, again.client() as client:
        lost = [i for i in outcome.stored if client.get(f"/v1/clips/{i}").status_code != 200]
    FIGURES.print(
        f"stopped under load: ended after {took:.1f} s; {len(outcome.stored)} clips acknowledged, "
        f"{len(lost)} lost; statuses {dict(outcome.statuses)}"
    )
    assert not lost
    assert set(outcome.statuses) <= {200, 202, 429, 503}
