"""What PostgreSQL adds: writers that wait, signals, limits, and one order of texts."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest
from sqlalchemy import text

from app.errors import ConfigurationError, DatabaseDamaged, DiskFull, StorageError
from app.store.clips import versions as library
from app.store.database import postgresql, schema
from app.store.database.access import ServerOptions
from app.store.database.engine import Database
from app.store.database.signals import Listener, Signal
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, NewJob
from app.store.store import Store
from tests import databases
from tests.live import wait_until
from tests.store.conftest import AddJob

pytestmark = pytest.mark.postgresql_only
WAIT_S = 120.0


def test_a_reader_cannot_write(store: Store) -> None:
    with pytest.raises(StorageError, match="read-only"), store.read() as tx:
        library.bump(tx)
    with store.write() as tx:  # the same connection, from the pool
        assert library.bump(tx) == 1


def test_writers_run_one_after_the_other_and_rows_of_their_own_do_not_wait(
    store: Store, database_url: str
) -> None:
    other = Database(database_url)
    began, may_end = threading.Event(), threading.Event()

    def write() -> None:
        with store.write() as tx:
            library.bump(tx)
            began.set()
            may_end.wait(WAIT_S)

    thread = threading.Thread(target=write)
    thread.start()
    began.wait(WAIT_S)
    with other.write_row() as tx:
        tx.execute(text("INSERT INTO tombstones VALUES ('clip', 1)"))
    threading.Timer(0.2, may_end.set).start()
    with other.write() as tx:  # it waits, so it sees what the first has written
        assert library.version(tx) == 1
    thread.join()
    other.close()


def test_a_statement_may_not_take_longer_than_its_limit(database_url: str) -> None:
    database = Database(database_url, options=ServerOptions(2, statement_timeout_s=0.1))
    with pytest.raises(StorageError, match="too long"), database.read() as tx:
        tx.execute(text("SELECT pg_sleep(60)"))
    database.close()


def test_a_process_has_no_more_connections_than_its_limit(
    database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    database = Database(database_url, options=ServerOptions(connections=2))
    monkeypatch.setattr(database.engine.pool, "_timeout", 0.05)
    with (
        database.read(),
        database.read(),
        pytest.raises(StorageError, match="All connections"),
        database.read(),
    ):
        pass
    database.close()


def test_a_writer_that_hangs_loses_the_lock(
    store: Store, database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    hung = postgresql._BEGIN[postgresql.Access.WRITE].replace("60000", "100")
    monkeypatch.setitem(postgresql._BEGIN, postgresql.Access.WRITE, hung)
    other = Database(database_url)

    def hang() -> None:
        with store.write() as tx:
            library.bump(tx)
            with other.write() as second:  # it gets the lock while the first does nothing
                assert library.version(second) == 0
            library.bump(tx)

    with pytest.raises(StorageError, match="cannot be used"):
        hang()
    other.close()


def test_a_connection_that_breaks_is_replaced(store: Store) -> None:
    def read_while_it_breaks() -> None:
        with store.read() as tx:
            _break_connections(store)
            library.version(tx)

    with pytest.raises(StorageError, match="cannot be used"):
        read_while_it_breaks()
    with store.read() as tx:
        assert library.version(tx) == 0


def test_a_server_that_does_not_answer_is_a_storage_error(tmp_path: Path) -> None:
    database = Database(f"postgresql://nobody@/nothing?host={tmp_path}")
    with pytest.raises(StorageError, match="cannot be used"), database.read():
        pass
    database.close()


@pytest.mark.parametrize(
    ("state", "failure"),
    [
        ("53100", DiskFull),
        ("XX001", DatabaseDamaged),
        ("40P01", StorageError),
        ("57P01", StorageError),
        ("23505", None),
    ],
)
def test_states_of_sql_mean_failures_of_the_store(
    state: str, failure: type[StorageError] | None
) -> None:
    error = type("Failed", (Exception,), {"sqlstate": state})("some reason\nDETAIL: a row")
    found = postgresql.failure_of(error)
    assert type(found) is (failure or type(None))
    assert "a row" not in str(found)


def test_the_first_query_of_a_transaction_may_be_streamed(store: Store) -> None:
    with store.read() as tx:
        rows = tx.execution_options(yield_per=2).execute(text("SELECT generate_series(1, 5)"))
        assert [row[0] for row in rows] == [1, 2, 3, 4, 5]


def test_another_kind_of_database_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="SQLite and PostgreSQL"):
        Database("mysql://somewhere/kinedex")


def test_all_texts_are_sorted_by_their_code_points(store: Store) -> None:
    with store.read() as tx:
        assert tx.execute(text(postgresql._COLLATED)).all() == []


def test_an_upgrade_makes_the_order_the_same_in_a_database_of_any_language(
    store: Store, database_url: str
) -> None:
    with store.write() as tx:
        other = 'ALTER TABLE tombstones ALTER clip_id TYPE VARCHAR COLLATE "default"'
        tx.exec_driver_sql(other)
    with store.read() as tx:
        assert tx.execute(text(postgresql._COLLATED)).all() == [("tombstones", "clip_id")]
    schema.upgrade(database_url)
    with store.read() as tx:
        assert tx.execute(text(postgresql._COLLATED)).all() == []


def test_signals_arrive_when_their_transaction_commits(store: Store, add_job: AddJob) -> None:
    woken = threading.Event()
    listener = Listener(store.database, [Signal.QUEUE], woken.set)
    listener.begin()
    wait_until(lambda: listener.is_listening and woken.is_set(), WAIT_S)
    woken.clear()
    with pytest.raises(ZeroDivisionError), store.write() as tx:
        1 / jobs.enqueue(tx, NewJob(JobKind.FIT)).progress
    with store.write() as tx:
        library.bump(tx)  # another signal
    time.sleep(0.1)
    assert not woken.is_set()
    add_job()
    assert woken.wait(WAIT_S)
    listener.end()


def test_a_listener_connects_again(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.store.database.signals.RECONNECT_S", 0.01)
    calls: list[float] = []
    listener = Listener(store.database, [Signal.LIBRARY], lambda: calls.append(time.monotonic()))
    listener.begin()
    wait_until(lambda: calls, WAIT_S)
    _break_connections(store)
    wait_until(lambda: len(calls) == 2, WAIT_S)
    listener.end()


def _break_connections(store: Store) -> None:
    name = store.database.engine.url.database
    databases.postgresql_server().execute(
        f"SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = '{name}'"
    )
