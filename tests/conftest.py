"""Services that run for the whole session. A test that needs other settings starts its own."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from app.demo import demo_clips
from tests.live import Live, serve

ACTORS = ("ada", "bruno")
TASKS = ("walk", "wave", "kick")

# WordNet takes seconds to load, in every fit of every library; its own test sets this to true.
os.environ.setdefault("KINEDEX_WORDNET", "false")

# On a busy machine every example takes long, and that says nothing about the code.
settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("busy")


@pytest.fixture(scope="session")
def idle_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """The API without a worker: uploaded clips stay queued. Files may have 300,000 bytes."""
    with serve(tmp_path_factory.mktemp("idle") / "data", max_upload_bytes=300_000) as live:
        yield live


@pytest.fixture(scope="session")
def demo_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """API and worker with 12 ready clips (2 actors, 3 tasks, 2 takes) and fitted models."""
    with serve(tmp_path_factory.mktemp("demo") / "data", worker=True) as live:
        clips = demo_clips(ACTORS, TASKS, takes=2)
        answers = [live.upload(clip).json() for clip in clips]
        for answer in answers:
            assert live.wait_for_job(answer["job"]["id"])["state"] == "succeeded"
        with live.client() as client:
            job = client.post("/v1/models/fit").json()["job"]
        assert live.wait_for_job(job["id"])["state"] == "succeeded"
        yield live
