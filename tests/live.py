"""A running Kinedex: a real API process, and a worker process, over a new data directory."""

from __future__ import annotations

import os
import socket
import ssl
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx2

from app.demo import DemoClip, demo_clips
from tests import databases

ACTORS = ("ada", "bruno")
TASKS = ("walk", "wave", "kick")
"""Of the demo library, with two takes each."""

NET_S = 300.0
"""Seconds. No wait of a test is so long, but on a machine that does much else at the same time."""
NO_TLS = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
"""A context without certificates: to read them takes a tenth of a second for each client."""
ENDED = {"succeeded", "failed", "canceled"}


@dataclass(frozen=True)
class Live:
    """A running API. log: the file of its log."""

    url: str
    data_dir: Path
    log: Path

    def client(self, **options: Any) -> httpx2.Client:
        """An HTTP client of the service, which ignores proxy settings of the machine."""
        return httpx2.Client(
            base_url=self.url, timeout=NET_S, trust_env=False, verify=NO_TLS, **options
        )

    def upload(self, clip: DemoClip, **fields: str) -> httpx2.Response:
        """Upload a demo clip with its labels."""
        labels = {"person": clip.person, "task": clip.task, "words": " ".join(clip.words)}
        with self.client() as client:
            return client.post(
                "/v1/clips", files={"file": (clip.path, clip.content)}, data=labels | fields
            )

    def wait_for_job(self, job_id: str, seconds: float = NET_S) -> dict[str, Any]:
        """Wait until the job has ended, and return it."""

        def ended() -> dict[str, Any] | None:
            with self.client() as client:
                job: dict[str, Any] = client.get(f"/v1/jobs/{job_id}").json()
            return job if job["state"] in ENDED else None

        return wait_until(ended, seconds)


def wait_until(condition: Callable[[], Any], seconds: float) -> Any:
    """Call `condition` until its result is true, and return the result. Raises TimeoutError."""
    deadline = time.monotonic() + seconds
    while not (result := condition()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"the condition was not true within {seconds} s")
        time.sleep(0.05)
    return result


@contextmanager
def serve(data_dir: Path, *, worker: bool = False, **settings: object) -> Iterator[Live]:
    """An API process, and a worker process if `worker`; both end with the block.

    settings: values of settings by their names in lower case, without the prefix. Without one, no
    call meets the limit of its time, since a test may run on a busy machine.
    """
    settings = {"request_timeout_s": NET_S, "query_timeout_s": NET_S} | settings
    if not databases.is_sqlite():
        settings.setdefault("database_url", databases.url_for(data_dir))
    data_dir.mkdir(parents=True, exist_ok=True)
    port, log = _free_port(), data_dir.parent / f"{data_dir.name}.api.log"
    variables = {f"KINEDEX_{name.upper()}": str(value) for name, value in settings.items()}
    variables |= {"KINEDEX_DATA_DIR": str(data_dir), "KINEDEX_PORT": str(port)}
    environment = os.environ | variables
    live = Live(f"http://127.0.0.1:{port}", data_dir, log)
    with _process("app.api.server", environment, log) as api:
        wait_until(lambda: _is_ready(live, api), NET_S)
        if not worker:
            yield live
            return
        with _process("app.worker", environment, log.with_suffix(".worker.log")):
            yield live


@contextmanager
def _process(
    module: str, environment: dict[str, str], log: Path
) -> Iterator[subprocess.Popen[bytes]]:
    command = [sys.executable, "-m", module]
    with log.open("wb") as lines:
        process = subprocess.Popen(command, env=environment, stdout=lines, stderr=lines)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(60)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _is_ready(live: Live, process: subprocess.Popen[bytes]) -> bool:
    if process.poll() is not None:
        raise RuntimeError(f"the API did not start:\n{live.log.read_text()}")
    try:
        with live.client() as client:
            return bool(client.get("/readyz").status_code == 200)
    except httpx2.TransportError:
        return False


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


@contextmanager
def serve_demo(data_dir: Path) -> Iterator[Live]:
    """API and worker with 12 ready clips (2 actors, 3 tasks, 2 takes) and fitted models."""
    with serve(data_dir, worker=True) as live:
        answers = [live.upload(clip).json() for clip in demo_clips(ACTORS, TASKS, takes=2)]
        for answer in answers:
            assert live.wait_for_job(answer["job"]["id"])["state"] == "succeeded"
        with live.client() as client:
            job = client.post("/v1/models/fit").json()["job"]
        assert live.wait_for_job(job["id"])["state"] == "succeeded"
        yield live
