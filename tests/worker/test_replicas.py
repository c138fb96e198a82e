"""Two API processes and three workers share a PostgreSQL database, and are killed at random.

Nothing that was acknowledged is lost, and nothing is done twice in effect. `-s` prints figures.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import httpx2
import psutil
import pytest
from sqlalchemy import select

from app.demo import DemoClip, demo_clips
from app.store.database.tables import clip_arrays, clips, jobs
from app.store.store import Store
from tests import databases
from tests.live import NET_S, NO_TLS, _free_port, wait_until

pytestmark = [pytest.mark.slow, pytest.mark.postgresql_only]

KILLS = int(os.environ.get("TESTS_KILLS", "20"))
SECONDS_BETWEEN = 2.0
SEED = 20
API, WORKER = "app.api.server", "app.worker"


@dataclass
class Replica:
    """One process, which is started again when it was killed. port: of an API, else 0."""

    module: str
    environment: dict[str, str]
    log: Path
    port: int = 0
    process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        with self.log.open("ab") as lines:
            command = [sys.executable, "-m", self.module]
            self.process = subprocess.Popen(
                command, env=self.environment, stdout=lines, stderr=lines
            )

    def kill(self) -> None:
        """SIGKILL the process alone; its children must end by themselves."""
        assert self.process is not None
        children = psutil.Process(self.process.pid).children(recursive=True)
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        _, alive = psutil.wait_procs(children, timeout=NET_S)
        assert not alive


@dataclass
class Sent:
    """What clients know. acknowledged: ids by the content's path; tries: calls of uploads."""

    acknowledged: dict[str, str] = field(default_factory=dict)
    tries: int = 0
    kills: Counter[str] = field(default_factory=Counter)


@contextmanager
def _replicas(folder: Path, url: str) -> Iterator[list[Replica]]:
    settings = {
        "DATA_DIR": str(folder / "data"),
        "DATABASE_URL": url,
        "ANALYSIS_PROCESSES": "1",
        "JOB_LEASE_S": "10",
        "JOB_HEARTBEAT_S": "1",
        "REQUEST_TIMEOUT_S": str(NET_S),
        "LOG_LEVEL": "warning",
        "REFIT_GROWTH": "1000",
    }
    (folder / "data").mkdir()
    common = dict(os.environ) | {f"KINEDEX_{name}": value for name, value in settings.items()}
    made = []
    for number in range(2):
        port = _free_port()
        environment = common | {"KINEDEX_PORT": str(port)}
        made.append(Replica(API, environment, folder / f"api{number}.log", port))
    made += [Replica(WORKER, common, folder / f"worker{number}.log") for number in range(3)]
    try:
        made[0].start()  # it makes the library
        wait_until(lambda: _is_ready(made[0]), NET_S)
        for replica in made[1:]:
            replica.start()
        yield made
    finally:
        for replica in made:
            if replica.process is not None:
                replica.process.terminate()
        for replica in made:
            if replica.process is not None:
                replica.process.wait(NET_S)


def _client(replica: Replica) -> httpx2.Client:
    url = f"http://127.0.0.1:{replica.port}"
    return httpx2.Client(base_url=url, timeout=NET_S, trust_env=False, verify=NO_TLS)


def _is_ready(replica: Replica) -> bool:
    try:
        with _client(replica) as client:
            return bool(client.get("/readyz").status_code == 200)
    except httpx2.TransportError:
        return False


def _upload(replica: Replica, clip: DemoClip, sent: Sent) -> None:
    """One try to upload a clip; the same bytes are the same clip, however often they come."""
    sent.tries += 1
    with _client(replica) as client:
        try:
            answer = client.post(
                "/v1/clips",
                files={"file": (clip.path, clip.content)},
                data={"person": clip.person, "task": clip.task},
            )
        except httpx2.TransportError:
            time.sleep(0.05)
            return
    if answer.status_code in (200, 202):
        sent.acknowledged[clip.path] = answer.json()["clip"]["id"]


@pytest.fixture(scope="module")
def many() -> list[DemoClip]:
    return list(demo_clips(tasks=("kick", "wave"), takes=3))


def test_nothing_is_lost_or_done_twice(tmp_path: Path, many: list[DemoClip]) -> None:
    url, draw, sent = databases.url_for(tmp_path), random.Random(SEED), Sent()
    began = time.monotonic()
    with _replicas(tmp_path, url) as replicas:
        apis = replicas[:2]
        next_kill = time.monotonic() + SECONDS_BETWEEN
        while len(sent.acknowledged) < len(many) or sum(sent.kills.values()) < KILLS:
            waiting = [clip for clip in many if clip.path not in sent.acknowledged]
            if waiting:
                _upload(draw.choice(apis), draw.choice(waiting), sent)
            else:
                time.sleep(0.1)
            if time.monotonic() >= next_kill and sum(sent.kills.values()) < KILLS:
                victim = draw.choice(replicas)
                victim.kill()
                victim.start()
                sent.kills[victim.module] += 1
                next_kill = time.monotonic() + draw.uniform(0.5, 1.5) * SECONDS_BETWEEN
        wait_until(lambda: _is_ready(apis[0]), NET_S)
        wait_until(lambda: _are_settled(apis[0], len(many)), 2 * NET_S)
    _check(url, tmp_path / "data" / "files", sent)
    print(
        f"\n{sum(sent.kills.values())} kills ({dict(sent.kills)}) in"
        f" {time.monotonic() - began:.0f} s; {len(sent.acknowledged)} clips acknowledged after"
        f" {sent.tries} calls; load {os.getloadavg()[0]:.1f}"
    )


def _are_settled(api: Replica, count: int) -> bool:
    with _client(api) as client:
        counted = [
            client.get("/v1/clips", params={"state": state, "limit": 1}).json()["total"]
            for state in ("ready", "failed")
        ]
    return bool(sum(counted) >= count)


def _check(url: str, files: Path, sent: Sent) -> None:
    store = Store.open(url, files)
    with store.read() as tx:
        rows = tx.execute(select(clips.c.id, clips.c.state, clips.c.sha256)).all()
        of_clips = select(jobs.c.clip_id).where(jobs.c.kind == "ingest")
        ingests = Counter(tx.execute(of_clips).scalars())
        open_jobs = tx.execute(select(jobs.c.id).where(jobs.c.owner.is_not(None))).all()
        arrays = Counter(tx.execute(select(clip_arrays.c.clip_id)).scalars())
        attempts = Counter(tx.execute(select(jobs.c.attempts)).scalars())
    store.close()
    assert {row.id for row in rows} == set(sent.acknowledged.values())
    assert {row.state for row in rows} == {"ready"}
    assert len({row.sha256 for row in rows}) == len(rows)
    assert set(ingests.values()) == {1}
    assert not open_jobs
    assert set(arrays) == {row.id for row in rows}
    assert len(set(arrays.values())) == 1
    print(f"\n{len(rows)} clips, each ready once; jobs by attempts: {dict(attempts)}")
