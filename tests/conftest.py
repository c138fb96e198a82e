"""Services that run for the whole session. A test that needs other settings starts its own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from tempfile import gettempdir

import pytest
from hypothesis import HealthCheck, settings

from tests import databases
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


STORE = Path(__file__).parent / "store"
USES_DATABASE = {"store", "database_url"}
"""Fixtures. The tests of the store that use one run on both kinds of databases; elsewhere a module
says by a mark that its tests do."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Lets a test run on SQLite, on PostgreSQL, or on both: see `tests.databases`."""
    marks = {mark.name for mark in metafunc.definition.iter_markers()}
    is_of_store = STORE in metafunc.definition.path.parents
    is_on_both = "both_databases" in marks or (
        is_of_store and bool(USES_DATABASE & set(metafunc.fixturenames))
    )
    kinds = [databases.kind()]
    if "sqlite_only" in marks:
        kinds = [databases.SQLITE]
    elif "postgresql_only" in marks:
        kinds = [databases.POSTGRESQL]
    elif is_on_both and databases.is_sqlite():
        kinds = [databases.SQLITE, databases.POSTGRESQL]
    if kinds != [databases.SQLITE]:
        metafunc.fixturenames.append("database_kind")
        metafunc.parametrize("database_kind", kinds, indirect=True, scope="module")


@pytest.fixture(scope="module", autouse=True)
def database_kind(request: pytest.FixtureRequest) -> Iterator[str]:
    """The kind of the databases that the tests of a module make."""
    chosen: str = getattr(request, "param", databases.SQLITE)
    with databases.of_kind(chosen):
        yield chosen


@pytest.fixture(autouse=True)
def _databases() -> Iterator[None]:
    with databases.released():
        yield


@pytest.fixture(scope="session", autouse=True)
def _database_server() -> Iterator[None]:
    yield
    databases.end()


@pytest.fixture(scope="session")
def _idle_services(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[], Live]]:
    """Returns the idle service of the present kind of database, and starts it at first."""
    with ExitStack() as stack:

        @cache
        def of_kind(kind: str) -> Live:
            folder = tmp_path_factory.mktemp(f"idle_{kind}") / "data"
            return stack.enter_context(serve(folder, max_upload_bytes=300_000))

        yield lambda: of_kind(databases.kind())


@pytest.fixture(scope="module")
def idle_service(
    _idle_services: Callable[[], Live],
    database_kind: str,
) -> Live:
    """The API without a worker: uploaded clips stay queued. Files may have 300,000 bytes."""
    return _idle_services()


@pytest.fixture(scope="session")
def demo_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """API and worker with 12 ready clips (2 actors, 3 tasks, 2 takes) and fitted models.

    Tests may add to it.
    """
    with serve_demo(tmp_path_factory.mktemp("demo") / "data") as live:
        yield live
