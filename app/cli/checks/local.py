"""Checks the installation and the library of this machine. Without --mend, nothing is changed."""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING

import typer

from app.cli.checks.contents import REPAIR, check_contents, check_names
from app.cli.checks.finding import Care, Finding, fine, note, problem
from app.cli.checks.queue import check_disk, check_queue
from app.cli.settings import settings_of
from app.errors import BadField, ConfigurationError
from app.kinedex_error import KinedexError

if TYPE_CHECKING:
    from app.config import Settings
    from app.store.store import Store

EXTRAS = {
    "audio": ("soundfile", "beats from recordings"),
    "plots": ("matplotlib", "pictures of `kinedex evaluate`"),
    "words": ("wn", "words of similar meaning"),
    "dataframes": ("pandas", "`to_dataframe()` of the Python client"),
    "postgres": ("psycopg", "a PostgreSQL database"),
    "s3": ("obstore", "files in a bucket"),
}
"""By extra: the module that it installs, and what needs it."""


def check_machine(context: typer.Context, care: Care) -> Iterator[Finding]:
    """Settings, data directory, database, files, worker, port, isolation and extras."""
    try:
        settings = settings_of(context)
    except ConfigurationError as failure:
        yield problem("settings", failure.detail, "Correct these settings.")
        return
    yield fine("settings", "all settings are valid")
    folder = list(_check_folder(settings))
    yield from folder
    if settings.data_dir.is_dir():
        yield check_disk(shutil.disk_usage(settings.data_dir).free)
        yield from _check_library(settings, care)
    yield _check_address(settings)
    yield _check_isolation()
    yield from _check_extras()


def _check_folder(settings: Settings) -> Iterator[Finding]:
    path = settings.data_dir
    if not path.is_dir():
        yield problem(
            "data directory",
            f"{path} {'is not a folder' if path.exists() else 'does not exist'}",
            "Correct --data-dir or KINEDEX_DATA_DIR, or make a library: `kinedex serve`.",
        )
        return
    try:
        with tempfile.TemporaryFile(dir=path):
            yield fine("data directory", f"{path.resolve()} can be written")
    except OSError as failure:
        advice = f"Run Kinedex as the owner of {path}, or change its rights."
        yield problem("data directory", f"{path} cannot be written: {failure.strerror}", advice)
    mode = stat.S_IMODE(path.stat().st_mode)
    if mode & stat.S_IRWXO:
        found = f"all accounts of this machine can open {path} (mode {mode:o})"
        yield note("permissions", found, f"Close it: chmod 700 {path}")
    elif path.stat().st_uid != os.geteuid():
        yield note("permissions", f"another account owns {path}")


def _check_library(settings: Settings, care: Care) -> Iterator[Finding]:
    """The database and the files of an existing library."""
    from app.store import identity
    from app.store.database import schema
    from app.store.store import Store

    try:
        if not identity.is_database_there(settings.database):
            identity.refuse_files_without_database(settings.database, settings.files_place)
            yield note("database", "there is no library yet", "`kinedex serve` makes one.")
            return
        schema.check(settings.database)
        library_id = identity.check(settings.database, settings.files_place)
        store = Store.open(settings.database, settings.files_place, library_id)
    except KinedexError as failure:
        yield problem("database", failure.detail, _advice_for(failure))
        return
    yield fine("database", f"schema {schema.state(settings.database).current} is current")
    try:
        yield from _check_store(store, care)
    finally:
        store.close()


def _check_store(store: Store, care: Care) -> Iterator[Finding]:
    from datetime import UTC, datetime

    from app.store.upkeep.counts import count_clips_by_state, count_open_jobs

    try:
        yield from check_names(store) if care.is_quick else check_contents(store, care)
        with store.read() as tx:
            jobs, clips = count_open_jobs(tx), count_clips_by_state(tx)
    except BadField:
        raise
    except KinedexError as failure:
        yield problem("database", failure.detail, REPAIR)
        return
    if clips.get("failed"):
        advice = "`kinedex clips list --state failed` lists them, `clips show` says why."
        noun = "clip" if clips["failed"] == 1 else "clips"
        yield note("clips", f"{clips['failed']} {noun} could not be analyzed", advice)
    now = datetime.now(UTC)
    yield check_queue([(j.kind, j.state, j.count, (now - j.oldest).total_seconds()) for j in jobs])


def _advice_for(failure: KinedexError) -> str:
    return {
        "database_out_of_date": "Stop Kinedex, make a backup, and run `kinedex db upgrade`.",
        "library_mismatch": "Follow the sentence above; `kinedex db adopt-files` is the last way.",
        "configuration": "Correct KINEDEX_DATABASE_URL.",
    }.get(failure.code, REPAIR)


def _check_address(settings: Settings) -> Finding:
    from app.services.exposure import refuse_taken_address

    address = f"{settings.host} port {settings.port}"
    try:
        refuse_taken_address(settings)
    except ConfigurationError:
        found = f"{address} is in use, perhaps by Kinedex itself"
        advice = "If Kinedex does not run, choose another port: KINEDEX_PORT or --port."
        return note("port", found, advice)
    return fine("port", f"{address} is free: no service runs there")


def _check_isolation() -> Finding:
    from app.services.children import sandbox

    missing = sandbox.status().missing
    if missing:
        found = f"the kernel does not keep analysis processes from {', '.join(missing)}"
        advice = "Linux 6.12 or newer can do it; a container must allow Landlock and seccomp."
        return note("isolation", found, advice)
    return fine("isolation", "analysis processes have no other files, network or processes")


def _check_extras() -> Iterator[Finding]:
    for extra, (module, purpose) in EXTRAS.items():
        if find_spec(module) is None:
            advice = (
                "If you need it: in a checkout run `make install`; otherwise run "
                f"`pip install {module}` for the Python of Kinedex."
            )
            yield note("extras", f"`{extra}` is not installed ({purpose})", advice)
        else:
            yield fine("extras", f"`{extra}` is installed")
