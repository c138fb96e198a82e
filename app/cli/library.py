"""The command that imports clips, and functions that wait for queued work."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import metadata_of
from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import open_library, remote_of
from app.cli.working import working_on

if TYPE_CHECKING:
    from app.services.imports.options import ImportOptions
    from app.services.library.library import Library
    from app.store.jobs.record import JobRecord

POLL_S = 0.2
PROGRESS_STEPS = 1000
"""Steps of a progress bar. The progress of a job is a number from 0 to 1."""
FAILURE = 1
"""The exit code of a command that failed."""
RECENT_JOBS = 10
"""The newest fits among which an open one is searched."""


Person = Annotated[str | None, typer.Option(help="The person in files that name none.")]
Task = Annotated[str | None, typer.Option(help="The task in files that name none.")]
Words = Annotated[
    str | None, typer.Option(help="Words of files that name none, separated by spaces.")
]
License = Annotated[str | None, typer.Option(help="The license of files that name none.")]
Source = Annotated[str | None, typer.Option(help="The source of files that name none.")]
Meta = Annotated[
    list[str] | None,
    typer.Option("--meta", help="Metadata as KEY=VALUE, as condition=tired; may be repeated."),
]
Labels = Annotated[
    str | None,
    typer.Option(
        help="Labels from paths: a pattern like {person}/{task}/{take}.bvh. A name that is no label"
        " becomes metadata; * is any name, ** any folders."
    ),
]
Overwrite = Annotated[
    bool, typer.Option("--overwrite", help="Replace labels that somebody edited since, too.")
]


def import_clips(
    context: typer.Context,
    path: Annotated[Path, typer.Argument(help="A folder, a ZIP, or a motion file.")],
    person: Person = None,
    task: Task = None,
    words: Words = None,
    license: License = None,
    source: Source = None,
    meta: Meta = None,
    labels: Labels = None,
    overwrite: Overwrite = False,
    wait: Annotated[
        bool, typer.Option(help="Analyze now; with --no-wait, a worker analyzes the clips later.")
    ] = True,
    as_json: AsJson = False,
) -> None:
    """Import a folder (with or without manifest.csv), a ZIP or a file.

    Labels come from a row of manifest.csv, else from --labels, else from --person and the others.
    Files that the library already has get changed labels, except those that somebody edited since.
    So you can correct a manifest and import it again, or repeat an interrupted import. The exit
    code is 1 if files failed, and 2 if no file could be imported.
    """
    from app.cli import import_report
    from app.services.imports.options import ImportOptions

    given = {"person": person, "task": task, "words": words, "license": license, "source": source}
    values: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if meta:
        values["metadata"] = metadata_of(meta)
    if remote_of(context) is not None:
        from app.cli.upload import import_to_service

        import_to_service(
            context,
            path,
            wait=wait,
            as_json=as_json,
            given={**values, "labels": labels, "overwrite": overwrite or None},
        )
        return
    with open_library(context) as lib:
        job = register(lib, path, ImportOptions(values, labels, overwrite))
        if wait:
            with working(lib):
                job = follow(lib, job.id, "analyzing")
                fit_if_due(lib)
        if as_json:
            print_json(import_report.local_document(lib, job))
        elif wait or not job.is_open:
            import_report.show(job, import_report.local_files(lib, job.id))
        else:
            typer.echo(f"{job.id}: registered; a worker analyzes the clips.")
    if code := import_report.exit_code(job):
        raise typer.Exit(code)


def register(lib: Library, path: Path, options: ImportOptions | None = None) -> JobRecord:
    """Import all files under `path` with a progress bar; returns the job that analyzes them."""
    from app.services.imports import imports

    with progress_bar() as bar:
        task = bar.add_task("registering", total=None)
        job = imports.import_path(
            lib,
            path,
            lambda done, total, _: bar.update(task, completed=done, total=total),
            options,
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
