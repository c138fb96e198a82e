"""Services that run for the whole session. A test that needs other settings starts its own."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from tempfile import gettempdir

import pytest
from hypothesis import HealthCheck, settings

from tests.live import Live, serve, serve_demo

# WordNet takes seconds to load, in every fit of every library; its own test sets this to true.
os.environ.setdefault("KINEDEX_WORDNET", "false")

# Compiling librosa takes 20 s and more; all libraries of one process of tests share the result. Two
# that compile at the same time can spoil it: see `app/services/library/compiled_code.py`.
_COMPILED = Path(gettempdir()) / f"kinedex-tests-numba-{os.environ.get('PYTEST_XDIST_WORKER', '')}"
_COMPILED.mkdir(exist_ok=True)
os.environ["NUMBA_CACHE_DIR"] = str(_COMPILED)

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
    """API and worker with 12 ready clips (2 actors, 3 tasks, 2 takes) and fitted models.

    Tests may add to it.
    """
    with serve_demo(tmp_path_factory.mktemp("demo") / "data") as live:
        yield live
