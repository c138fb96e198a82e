"""`kill -9` of the API and of the worker while recordings are uploaded.

Run: pytest -m bench -s tests/bench/test_kill_recordings.py
The kills come during uploads and hit the API and the worker in turn. `kinedex serve` starts them
again. Afterwards every recording that was answered with 202 must exist, byte by byte, and its beats
must have been found.
"""

from __future__ import annotations

import hashlib
import random
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import httpx2
import psutil
import pytest

from app.demo import DemoClip
from app.demo.dances import Sound, dance
from tests.bench.page import Section
from tests.bench.processes import child_running, kill, tree_of
from tests.bench.product import API, WORKER, Product, serving
from tests.live import wait_until

FIGURES = Section(
    "kill_recordings",
    "Eight kills during uploads of recordings",
    trials="eight `kill -9` of the API or the worker while recordings are uploaded",
)

pytestmark = pytest.mark.bench

UPLOADS, KILLS = 60, 8
SEED = 17
READY_SECONDS = 600.0


@dataclass
class Sent:
    """The uploads of a run.

    acknowledged: SHA-256 of the recording, by clip id; refused: number of answers other than 202,
    by status; broken: uploads that a kill cut off; killed: the killed processes, in order.
    """

    acknowledged: dict[str, str] = field(default_factory=dict)
    refused: Counter[int] = field(default_factory=Counter)
    broken: int = 0
    killed: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def danced() -> DemoClip:
    return dance(61, bpm=100.0, seconds=8.0, sound=Sound.CLICKS, audio_offset=-0.5)


def test_an_acknowledged_recording_is_never_lost(danced: DemoClip, tmp_path: Path) -> None:
    sent = Sent()
    with serving(tmp_path / "data", log_level="warning") as product:
        uploads = threading.Thread(target=_upload_all, args=(product, danced, sent))
        uploads.start()
        draw = random.Random(SEED)
        for number in range(KILLS):
            _wait_for_uploads(sent, (number + 1) * UPLOADS // (KILLS + 1))
            time.sleep(draw.uniform(0.0, 0.3))
            _kill(product, (API, WORKER)[number % 2], sent)
        uploads.join(READY_SECONDS)
        assert not uploads.is_alive()
        _check(product, sent)
    _check_files(tmp_path / "data" / "files", sent)


def _recording(danced: DemoClip, number: int) -> bytes:
    """The recording of the dance, with another last sample for each number."""
    return danced.audio[:-2] + number.to_bytes(2, "little")


def _upload_all(product: Product, danced: DemoClip, sent: Sent) -> None:
    for number in range(UPLOADS):
        audio = _recording(danced, number)
        files = {
            "file": ("dance.bvh", danced.content + b"\n" * (number + 1)),
            "audio": ("dance.wav", audio),
        }
        try:
            with product.client() as client:
                answer = client.post("/v1/clips", files=files, data={"audio_offset": "-0.5"})
        except httpx2.TransportError:
            sent.broken += 1
            wait_until(lambda: _answers(product), 60.0)
            continue
        if answer.status_code == 202:
            sent.acknowledged[answer.json()["clip"]["id"]] = hashlib.sha256(audio).hexdigest()
        else:
            sent.refused[answer.status_code] += 1


def _wait_for_uploads(sent: Sent, count: int) -> None:
    wait_until(lambda: len(sent.acknowledged) + sent.broken >= count, READY_SECONDS)


def _kill(product: Product, module: str, sent: Sent) -> None:
    def found() -> psutil.Process | None:
        return child_running(product.supervisor, module)

    process: psutil.Process = wait_until(found, 60.0)
    kill(tree_of(process))
    sent.killed.append(f"{module} after {len(sent.acknowledged)}")
    wait_until(lambda: _answers(product), 60.0)


def _answers(product: Product) -> bool:
    try:
        with product.client() as client:
            return client.get("/readyz").status_code == 200
    except httpx2.TransportError:
        return False


def _check(product: Product, sent: Sent) -> None:
    def ended() -> bool:
        clips = product.items("/v1/clips")
        return all(clip["state"] in ("ready", "failed") for clip in clips)

    wait_until(ended, READY_SECONDS)
    clips = {clip["id"]: clip for clip in product.items("/v1/clips")}
    FIGURES.print(f"\nkilled: {'; '.join(sent.killed)}")
    FIGURES.print(
        f"{UPLOADS} uploads: {len(sent.acknowledged)} acknowledged, {sent.broken} cut off,"
        f" refused {dict(sent.refused)}; clips there {len(clips)}"
    )
    assert len(sent.acknowledged) >= UPLOADS // 2
    assert sent.acknowledged.keys() <= clips.keys()
    heard: Counter[str] = Counter()
    with product.client() as client:
        for clip_id, digest in sent.acknowledged.items():
            assert (clips[clip_id]["state"], clips[clip_id]["has_audio"]) == ("ready", True)
            audio = client.get(f"/v1/clips/{clip_id}/audio")
            assert hashlib.sha256(audio.content).hexdigest() == digest
            heard[client.get(f"/v1/clips/{clip_id}/keyposes").json()["beats_source"]] += 1
    FIGURES.print(
        f"all of them ready, their recordings byte by byte as sent; beats from {dict(heard)}"
    )
    assert heard == {"audio": len(sent.acknowledged)}


def _check_files(folder: Path, sent: Sent) -> None:
    """Each stored recording is complete under its name."""
    kept = {path.name: path for path in folder.rglob("*") if path.is_file()}
    for digest in sent.acknowledged.values():
        assert hashlib.sha256(kept[digest].read_bytes()).hexdigest() == digest
