"""The product as a user runs it: `kinedex serve` as a process, with its own directory."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx2
import psutil

from tests.bench.processes import kill, tree_of
from tests.live import wait_until
from tests.real_clips import real_clips

API, WORKER = "app.api.server", "app.worker"
START_SECONDS = 60.0
STOP_SECONDS = 30.0
ENDED = {"succeeded", "failed", "canceled"}


@dataclass(frozen=True)
class Product:
    """A running `kinedex serve`."""

    url: str
    data_dir: Path
    log: Path
    supervisor: psutil.Process

    def get(self, path: str, **query: Any) -> Any:
        """Return the answer of a call as JSON. A status of 400 or above raises HTTPStatusError."""
        with self.client() as client:
            answer = client.get(path, params=query)
            answer.raise_for_status()
            return answer.json()

    def client(self) -> httpx2.Client:
        return httpx2.Client(base_url=self.url, timeout=120.0, trust_env=False)

    def start_import(self, archive: Path) -> str:
        """Upload a ZIP and return the id of its job."""
        with self.client() as client, archive.open("rb") as content:
            answer = client.post("/v1/imports", files={"archive": (archive.name, content)})
        assert answer.status_code == 202, answer.text
        job: str = answer.json()["job"]["id"]
        return job

    def wait_for_job(self, job_id: str, seconds: float) -> dict[str, Any]:
        """Wait until the job has ended and return it."""

        def ended() -> dict[str, Any] | None:
            job: dict[str, Any] = self.get(f"/v1/jobs/{job_id}")
            return job if job["state"] in ENDED else None

        found: dict[str, Any] = wait_until(ended, seconds)
        return found

    def items(self, path: str, **query: Any) -> list[dict[str, Any]]:
        """All items of a list, page by page."""
        found: list[dict[str, Any]] = []
        cursor: dict[str, str] = {}
        while True:
            page = self.get(path, limit=200, **query, **cursor)
            found += page["items"]
            if page["next"] is None:
                return found
            cursor = {"cursor": page["next"]}


@contextmanager
def serving(data_dir: Path, **settings: object) -> Iterator[Product]:
    """Run `kinedex serve` on a free port. At the end it is terminated, or killed if that fails."""
    data_dir.mkdir(parents=True)
    log = data_dir.parent / f"{data_dir.name}.log"
    variables = {f"KINEDEX_{name.upper()}": str(value) for name, value in settings.items()}
    variables |= {"KINEDEX_DATA_DIR": str(data_dir), "OPENBLAS_NUM_THREADS": "1"}
    port = _free_port()
    command = [str(Path(sys.executable).with_name("kinedex")), "serve", "--port", str(port)]
    with log.open("wb") as lines:
        process = subprocess.Popen(command, env=os.environ | variables, stdout=lines, stderr=lines)
    product = Product(f"http://127.0.0.1:{port}", data_dir, log, psutil.Process(process.pid))
    try:
        wait_until(lambda: _is_ready(product, process), START_SECONDS)
        yield product
    finally:
        started = tree_of(product.supervisor)
        process.terminate()
        try:
            process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            kill(started)
            process.wait()


def zip_of_real_clips(target: Path) -> Path:
    """Make a ZIP of the folder of real clips, as a user would."""
    folder = real_clips()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                archive.write(file, file.relative_to(folder).as_posix())
    return target


def _is_ready(product: Product, process: subprocess.Popen[bytes]) -> bool:
    if process.poll() is not None:
        raise RuntimeError(f"kinedex serve did not start:\n{product.log.read_text()}")
    try:
        with product.client() as client:
            return client.get("/readyz").status_code == 200
    except httpx2.TransportError:
        return False


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
