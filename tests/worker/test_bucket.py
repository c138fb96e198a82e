"""The API and a worker whose files are in a bucket, as processes."""

from __future__ import annotations

import hashlib
import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from itertools import count, islice
from pathlib import Path

import httpx2
import pytest

from app.demo import demo_clips
from app.store.files.bucket import Bucket
from app.store.files.files import name_of
from tests import buckets
from tests.buckets import Buckets
from tests.live import NET_S, Live, _free_port, _is_ready, serve, wait_until

pytestmark = [pytest.mark.slow, pytest.mark.sqlite_only]

KILLS = 8


@pytest.fixture
def s3() -> Iterator[Buckets]:
    with buckets.running() as server:
        yield server


@pytest.fixture
def bucket(s3: Buckets, tmp_path: Path) -> Bucket:
    return s3.new(tmp_path / "data" / "files")


def test_an_upload_is_analyzed_read_in_parts_and_deleted(
    s3: Buckets, bucket: Bucket, tmp_path: Path
) -> None:
    given = {
        name.removeprefix("KINEDEX_").lower(): value
        for name, value in buckets.environment(bucket).items()
    }
    (clip,) = islice(demo_clips(["ada"], ["walk"]), 1)
    with serve(tmp_path / "data", worker=True, **given) as live, live.client() as client:
        answer = live.upload(clip).json()
        assert live.wait_for_job(answer["job"]["id"])["state"] == "succeeded"
        sha256, path = answer["clip"]["sha256"], f"/v1/clips/{answer['clip']['id']}"
        assert s3.read(bucket, name_of(sha256)) == clip.content
        part = client.get(f"{path}/file", headers={"Range": "bytes=5-24"})
        assert (part.status_code, part.content) == (206, clip.content[5:25])
        assert client.delete(path).status_code == 204
        wait_until(lambda: s3.names(bucket) == ["library-id"], NET_S)
    assert not list((tmp_path / "data" / "files").rglob(sha256))


class _Uploader(threading.Thread):
    """Sends a new clip as often as it can. acknowledged: the SHA-256 of those that were stored."""

    def __init__(self, live: Live, content: bytes) -> None:
        super().__init__()
        self.acknowledged: dict[str, str] = {}
        self.stop = threading.Event()
        self._live, self._content = live, content

    def run(self) -> None:
        with self._live.client() as client:
            for number in count():
                if self.stop.is_set():
                    return
                content = self._content + b" " * number + b"\n"
                try:
                    answer = client.post("/v1/clips", files={"file": ("w.bvh", content)})
                except httpx2.TransportError:
                    continue
                if answer.status_code == 202:
                    sha256 = hashlib.sha256(content).hexdigest()
                    self.acknowledged[answer.json()["clip"]["id"]] = sha256


def test_nothing_acknowledged_is_lost_when_the_api_is_killed(
    s3: Buckets, bucket: Bucket, tmp_path: Path
) -> None:
    port, data_dir = _free_port(), tmp_path / "data"
    data_dir.mkdir()
    live = Live(f"http://127.0.0.1:{port}", data_dir, tmp_path / "log")
    environment = os.environ | buckets.environment(bucket)
    environment |= {"KINEDEX_DATA_DIR": str(data_dir), "KINEDEX_PORT": str(port)}
    (clip,) = islice(demo_clips(["ada"], ["walk"]), 1)
    uploader, draw, kills = _Uploader(live, clip.content), random.Random(5), 0

    def start() -> subprocess.Popen[bytes]:
        with live.log.open("wb") as log:
            command = [sys.executable, "-m", "app.api.server"]
            process = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
        wait_until(lambda: _is_ready(live, process), NET_S)
        return process

    api = start()
    try:
        uploader.start()
        while kills < KILLS:
            before = len(uploader.acknowledged)
            wait_until(lambda: len(uploader.acknowledged) > before + 1, NET_S)  # noqa: B023
            time.sleep(draw.uniform(0, 0.3))
            api.kill()
            api.wait()
            kills += 1
            api = start()
        uploader.stop.set()
        uploader.join()
        assert len(uploader.acknowledged) >= KILLS
        with live.client() as client:
            for clip_id, sha256 in uploader.acknowledged.items():
                assert client.get(f"/v1/clips/{clip_id}").json()["sha256"] == sha256
            stored = client.get("/v1/clips?limit=500&fields=sha256").json()
        assert stored["next"] is None
        for item in stored["items"]:  # also those that nobody was told about
            content = s3.read(bucket, name_of(item["sha256"]))
            assert hashlib.sha256(content).hexdigest() == item["sha256"]
    finally:
        uploader.stop.set()
        api.kill()
        api.wait()
