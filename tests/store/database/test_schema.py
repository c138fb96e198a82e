"""Migrations and tables agree, and a database with another schema version is refused."""

from __future__ import annotations

import multiprocessing
from dataclasses import replace
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import create_mock_engine, text

from app.errors import DatabaseOutOfDate
from app.store import models
from app.store.clips import repository as clips
from app.store.database import schema, service_tables, tables
from app.store.database.engine import Database
from app.store.jobs import import_files, imports, leases
from app.store.jobs import repository as jobs
from app.store.jobs.import_files import FileOutcome, ImportOutcome
from app.store.jobs.imports import NewEntry
from app.store.jobs.record import JobKind, NewJob
from app.store.store import Store
from tests.store.conftest import AddClip

(METADATA,) = {tables.metadata, service_tables.metadata}


def test_migrations_and_tables_agree(store: Store) -> None:
    with store.read() as tx:
        context = MigrationContext.configure(tx, opts={"compare_type": True})
        assert compare_metadata(context, METADATA) == []


def test_the_revision_that_is_needed_is_alembics_newest(store: Store, database_url: str) -> None:
    with store.read() as tx:
        scripts = ScriptDirectory.from_config(schema._config(tx))
    found = schema.state(database_url)
    assert found.needed == scripts.get_current_head()
    names = {Path(script.path).name: script.revision for script in scripts.walk_revisions()}
    assert {name: name.partition("_")[0] for name in names} == names


def test_tables_can_be_made_on_postgresql() -> None:
    statements: list[str] = []
    engine = create_mock_engine("postgresql+psycopg://", lambda sql, *_, **__: None)
    engine = create_mock_engine(
        "postgresql+psycopg://",
        lambda sql, *_, **__: statements.append(str(sql.compile(dialect=engine.dialect))),
    )
    METADATA.create_all(engine, checkfirst=False)
    assert sum("CREATE TABLE" in statement for statement in statements) == len(METADATA.tables)


def test_an_empty_database_is_prepared_and_prepared_again(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/new.sqlite3"
    assert schema.state(url).is_empty
    with pytest.raises(DatabaseOutOfDate, match="kinedex db upgrade"):
        schema.check(url)
    schema.prepare(url)
    schema.prepare(url)
    schema.check(url)
    assert schema.upgrade(url).is_current


def test_a_start_does_not_upgrade_an_older_database(database_url: str) -> None:
    _set_revision(database_url, None)
    with pytest.raises(DatabaseOutOfDate, match="kinedex db upgrade"):
        schema.prepare(database_url)


def test_an_upgrade_keeps_the_data(store: Store, add_clip: AddClip, database_url: str) -> None:
    clip = add_clip("walk", ready=True, words=("walk", "slow"))
    database = Database(database_url, foreign_keys=False)
    with database.migrate() as tx:
        command.downgrade(schema._config(tx), "0001")
    database.close()
    assert schema.state(database_url).current == "0001"
    assert schema.upgrade(database_url).is_current
    with store.read() as tx:
        # Earlier versions do not know when a clip begins in its file.
        assert clips.get(tx, clip.id) == replace(clip, start_offset=None)


def test_an_upgrade_makes_large_results_small_and_keeps_every_file(
    store: Store, database_url: str
) -> None:
    long = "x" * 3000
    with store.write() as tx:
        job = jobs.enqueue(tx, NewJob(JobKind.IMPORT))
        claimed = leases.claim(tx, [JobKind.IMPORT], "worker")
        assert claimed is not None
        entries = [NewEntry(path, ImportOutcome.FAILED, problem={}) for path in ("a", long)]
        imports.add_entries(tx, job.id, entries)
        result = {"total": 2, "failed": 2, "files": [{"path": long}]}
        leases.succeed(tx, claimed.lease, result)
    database = Database(database_url, foreign_keys=False)
    with database.migrate() as tx:
        command.downgrade(schema._config(tx), "0005")
    database.close()
    schema.upgrade(database_url)
    with store.read() as tx:
        assert jobs.get(tx, job.id).result == {"total": 2, "failed": 2, "absent": 0}
        paths = [file.path for file in import_files.page(tx, job.id).items]
    assert paths[0] == "a"
    assert len(paths[1]) <= 500


def test_an_upgrade_renames_the_outcomes_of_imports(store: Store, database_url: str) -> None:
    result = {"total": 2, "ready": 1, "exists": 1, "failed": 0, "deleted": 0, "absent": 0}
    with store.write() as tx:
        job = jobs.enqueue(tx, NewJob(JobKind.IMPORT))
        claimed = leases.claim(tx, [JobKind.IMPORT], "worker")
        assert claimed is not None
        imports.add_entries(tx, job.id, [NewEntry("a.bvh", ImportOutcome.UNCHANGED)])
        leases.succeed(tx, claimed.lease, result)
    database = Database(database_url, foreign_keys=False)
    with database.migrate() as tx:
        command.downgrade(schema._config(tx), "0008")
        (outcome,) = tx.execute(text("SELECT outcome FROM import_entries")).scalars()
    database.close()
    assert outcome == "exists"
    schema.upgrade(database_url)
    with store.read() as tx:
        found = jobs.get(tx, job.id).result or {}
        (file,) = import_files.page(tx, job.id).items
    assert file.outcome is FileOutcome.UNCHANGED
    assert (found["new"], found["unchanged"], found["updated"]) == (1, 1, 0)


def test_an_upgrade_renames_the_recognizer_and_keeps_it(store: Store, database_url: str) -> None:
    with store.write() as tx:
        made = models.save(
            tx, "recognizer", meta={"a": 1}, arrays={}, library_version=1, library_size=1
        )
    database = Database(database_url, foreign_keys=False)
    with database.migrate() as tx:
        command.downgrade(schema._config(tx), "0014")
        assert tx.execute(text("SELECT kind FROM models")).scalars().all() == ["recogniser"]
    database.close()
    schema.upgrade(database_url)
    with store.read() as tx:
        assert models.current(tx, "recognizer") == made


def test_a_newer_database_is_refused(database_url: str) -> None:
    _set_revision(database_url, "9999")
    with pytest.raises(DatabaseOutOfDate, match="newer Kinedex"):
        schema.prepare(database_url)


def test_two_processes_may_prepare_at_once(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/shared.sqlite3"
    spawn = multiprocessing.get_context("spawn")
    processes = [spawn.Process(target=schema.prepare, args=(url,)) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(300)
    assert [process.exitcode for process in processes] == [0, 0, 0]
    schema.check(url)


def _set_revision(url: str, revision: str | None) -> None:
    database = Database(url)
    with database.write() as tx:
        tx.execute(text("DELETE FROM alembic_version"))
        if revision is not None:
            tx.execute(text("INSERT INTO alembic_version VALUES (:r)"), {"r": revision})
    database.close()
