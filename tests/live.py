"""A running Kinedex: the real API process, and a worker, over a directory of its own."""

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

from app.demo import DemoClip

START_SECONDS = 60.0
NO_TLS = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
"""Reading the machine's certificates would take a tenth of a second for each client."""
ENDED = {"succeeded", "failed", "canceled"}


@dataclass(frozen=True)
class Live:
    """A service that answers at `url`; `log` is the file of the API's lines."""

    url: str
    data_dir: Path
    log: Path

    def client(self, **options: Any) -> httpx2.Client:
        """A client of it; no proxy of the machine comes between."""
        return httpx2.Client(
            base_url=self.url, timeout=60.0, trust_env=False, verify=NO_TLS, **options
        )

    def upload(self, clip: DemoClip, **fields: str) -> httpx2.Response:
        """Hand in a demo clip with its labels."""
        labels = {"person": clip.person, "task": clip.task, "words": " ".join(clip.words)}
        with self.client() as client:
            return client.post(
                "/v1/clips", files={"file": (clip.path, clip.content)}, data=labels | fields
            )

    def wait_for_job(self, job_id: str, seconds: float = 120.0) -> dict[str, Any]:
        """The job when it has ended."""

        def ended() -> dict[str, Any] | None:
            with self.client() as client:
                job: dict[str, Any] = client.get(f"/v1/jobs/{job_id}").json()
            return job if job["state"] in ENDED else None

        return wait_until(ended, seconds)


def wait_until(look: Callable[[], Any], seconds: float) -> Any:
    """What `look` returns, as soon as that is true."""
    deadline = time.monotonic() + seconds
    while not (seen := look()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"waited {seconds} s in vain")
        time.sleep(0.05)
    return seen


@contextmanager
def serve(data_dir: Path, *, worker: bool = False, **settings: object) -> Iterator[Live]:
    """An API process, with a worker if asked for; both end with the block."""
    data_dir.mkdir(parents=True, exist_ok=True)
    port, log = _free_port(), data_dir.parent / f"{data_dir.name}.api.log"
    told = {f"KINEDEX_{name.upper()}": str(value) for name, value in settings.items()}
    environment = os.environ | told | {"KINEDEX_DATA_DIR": str(data_dir), "KINEDEX_PORT": str(port)}
    live = Live(f"http://127.0.0.1:{port}", data_dir, log)
    with _process("app.api.server", environment, log) as api:
        wait_until(lambda: _is_ready(live, api), START_SECONDS)
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
            process.wait(20)
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
