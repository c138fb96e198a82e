"""The command that imports clips, and functions that wait for queued work."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.output import AsJson, print_json, print_table, progress_bar
from app.cli.settings import open_library, remote_of
from app.cli.working import working_on

if TYPE_CHECKING:
    from app.services.library.library import Library
    from app.store.jobs.record import JobRecord

POLL_S = 0.2
PROGRESS_STEPS = 1000
"""Steps of a progress bar. The progress of a job is a number from 0 to 1."""
FAILURE = 1
"""The exit code of a command that failed."""
RECENT_JOBS = 10
"""The newest fits among which an open one is searched."""


def import_clips(
    context: typer.Context,
    path: Annotated[Path, typer.Argument(help="A folder, a ZIP, or a motion file.")],
    wait: Annotated[
        bool, typer.Option(help="Analyze now; with --no-wait, a worker analyzes the clips later.")
    ] = True,
    as_json: AsJson = False,
) -> None:
    """Import a folder (with or without manifest.csv), a ZIP or a file.

    Files that the library already has are skipped. So you can repeat an interrupted import.
    """
    from app.store.jobs.record import JobState

    if remote_of(context) is not None:
        from app.cli.upload import import_to_service

        import_to_service(context, path, wait=wait, as_json=as_json)
        return
    with open_library(context) as lib:
        job = register(lib, path)
        if wait:
            with working(lib):
                job = follow(lib, job.id, "analyzing")
                fit_if_due(lib)
        if as_json:
            print_json(_document(lib, job))
        elif wait:
            show_import(lib, job)
        else:
            typer.echo(f"{job.id}: registered; a worker analyzes the clips.")
    if job.state in (JobState.FAILED, JobState.CANCELED):
        raise typer.Exit(FAILURE)


def register(lib: Library, path: Path) -> JobRecord:
    """Import all files under `path` with a progress bar; returns the job that analyzes them."""
    from app.services.imports import imports

    with progress_bar() as bar:
        task = bar.add_task("registering", total=None)
        job = imports.import_path(
            lib, path, lambda done, total, _: bar.update(task, completed=done, total=total)
        )
        bar.update(task, completed=1, total=1)  # absent files of a manifest are not counted
        return job


def working(lib: Library) -> AbstractContextManager[None]:
    """Run a worker in a thread; it shares the queue with workers of other processes."""
    return working_on(lib.settings)


def follow(lib: Library, job_id: str, label: str) -> JobRecord:
    """Show the progress of a job until it ends; label: the text beside the progress bar."""
    from app.services.clips import jobs

    with progress_bar() as bar:
        task = bar.add_task(label, total=PROGRESS_STEPS)
        while True:
            job = jobs.get_job(lib, job_id)
            bar.update(task, completed=round(job.progress * PROGRESS_STEPS))
            if not job.is_open:
                return job
            time.sleep(POLL_S)


def fit_if_due(lib: Library) -> None:
    """Queue a fit if the library has changed enough, and wait for its end."""
    from app.services.training import models, refit

    fit = _open_fit(lib)
    if fit is None:
        with lib.store.read() as tx:
            is_due = refit.is_fit_due(tx, lib.settings.refit_growth)
        fit = models.request_fit(lib) if is_due else None
    if fit is not None:
        follow(lib, fit.id, "fitting models")


def _open_fit(lib: Library) -> JobRecord | None:
    """A fit that is queued or that runs in any worker; None if there is none."""
    from app.services.clips import jobs
    from app.store.jobs.record import JobKind

    recent = jobs.list_jobs(lib, kind=JobKind.FIT, limit=RECENT_JOBS).items
    return next((job for job in recent if job.is_open), None)


def _document(lib: Library, job: JobRecord) -> dict[str, Any]:
    """The job as in the API, but its result lists all recorded files."""
    from app.api.schemas.jobs import Job, JobFile
    from app.services.clips import jobs

    document: dict[str, Any] = Job.model_validate(job).model_dump(mode="json")
    if document["result"] is not None:
        files = [
            JobFile.model_validate(file).model_dump(mode="json")
            for file in jobs.all_files(lib, job.id)
        ]
        left_out = max(document["result"]["total"] - len(files), 0)
        document["result"] |= {"files": files, "files_left_out": left_out}
    return document


def show_import(lib: Library, job: JobRecord) -> None:
    """Print the numbers of files by result, and each failure with its reason."""
    result = job.result or {}
    if result:
        present = result["ready"] + result["exists"]
        typer.echo(
            f"{present} of {result['total']} files are in the library ({result['ready']} new)."
        )
        _show_failures(lib, job.id, result["absent"])
    if job.error:
        typer.echo(f"kinedex: {job.error['detail']}", err=True)


def _show_failures(lib: Library, job_id: str, absent: int) -> None:
    from app.services.clips import jobs
    from app.services.imports.plan import MOST_ABSENT
    from app.store.jobs.import_files import FileOutcome

    failures = [
        (file.path, _reason(file.error))
        for outcome in (FileOutcome.FAILED, FileOutcome.ABSENT)
        for file in jobs.all_files(lib, job_id, outcome)
        if file.error is not None
    ]
    if failures:
        print_table(("failed", "reason"), failures)
    if absent > MOST_ABSENT:
        typer.echo(f"A manifest names {absent - MOST_ABSENT} more files that do not exist.")


def _reason(problem: dict[str, Any]) -> str:
    places = [f"{place['location']}: {place['message']}" for place in problem["errors"]]
    # the detail of a file reader is often the same text as its only place
    return " ".join([problem["detail"], *(place for place in places if place != problem["detail"])])
