"""A worker removes jobs that ended longer ago than the settings say, and logs their number."""

from __future__ import annotations

import logging
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import update

from app.services.clips import jobs
from app.services.imports import imports
from app.services.library.library import Library
from app.store import audit
from app.store.database.ids import utc_now
from app.store.database.service_tables import audit_log
from app.store.database.tables import jobs as table
from app.worker.expiry import Expiry
from tests.libraries import settings_for
from tests.zip_archives import zip_archive


def _library(folder: Path, **settings: Any) -> tuple[Library, str]:
    """A library and the id of a job whose stored end is long ago."""
    lib = Library.open(settings_for(folder, **settings))
    job = imports.start_import(lib, zip_archive([("a.bvh", b"")]), "a.zip")
    jobs.cancel_or_remove(lib, job.id)
    long_ago = utc_now().replace(year=2020)
    with lib.store.write() as tx:
        tx.execute(update(table).where(table.c.id == job.id).values(finished_at=long_ago))
    return lib, job.id


def test_old_jobs_are_removed_and_that_is_logged(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    lib, _ = _library(tmp_path)
    with caplog.at_level(logging.INFO, logger="app.worker.expiry"):
        expiry = Expiry(lib)
        expiry.remove_if_due()
    assert jobs.list_jobs(lib).items == ()
    assert "removed 1 jobs that ended over 30 days ago" in caplog.text
    lib.close()


def test_a_second_round_waits_for_its_time(tmp_path: Path) -> None:
    lib, _ = _library(tmp_path / "a")
    expiry = Expiry(lib)
    expiry.remove_if_due()
    job = imports.start_import(lib, zip_archive([("b.bvh", b"")]), "b.zip")
    jobs.cancel_or_remove(lib, job.id)
    with lib.store.write() as tx:
        tx.execute(update(table).values(finished_at=utc_now().replace(year=2020)))
    expiry.remove_if_due()
    assert [one.id for one in jobs.list_jobs(lib).items] == [job.id]
    lib.close()


def test_no_job_is_removed_if_the_settings_keep_all(tmp_path: Path) -> None:
    lib, job_id = _library(tmp_path, job_retention_days=0)
    Expiry(lib).remove_if_due()
    assert [one.id for one in jobs.list_jobs(lib).items] == [job_id]
    lib.close()


def test_deleted_data_leave_the_log_after_the_reader_has_ended(tmp_path: Path) -> None:
    lib, job_id = _library(tmp_path)
    log = lib.settings.data_dir / "kinedex.sqlite3-wal"
    with lib.store.read() as tx:
        tx.execute(table.select()).all()
        jobs.cancel_or_remove(lib, job_id)
        assert not lib.store.erase_traces(wait_s=0.0)
        Expiry(lib).remove_if_due()  # does not wait for the reader
        assert job_id.encode() in log.read_bytes()
    Expiry(lib).remove_if_due()
    assert log.stat().st_size == 0
    assert job_id.encode() not in (lib.settings.data_dir / "kinedex.sqlite3").read_bytes()


def test_old_rows_of_the_audit_log_are_removed(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    lib = Library.open(settings_for(tmp_path, audit_retention_days=7))
    for action in ("old", "new"):
        with lib.store.write() as tx:
            audit.add(tx, audit.Call(action))
    long_ago = utc_now() - timedelta(days=8)
    with lib.store.write() as tx:
        old = update(audit_log).where(audit_log.c.action == "old")
        tx.execute(old.values(at=long_ago))
    with caplog.at_level(logging.INFO, logger="app.worker.expiry"):
        Expiry(lib).remove_if_due()
    with lib.store.read() as tx:
        left = audit.list_page(tx, audit.AuditFilter()).items
    assert [row.action for row in left] == ["new"]
    assert "removed 1 rows of the audit log older than 7 days" in caplog.text
    lib.close()
