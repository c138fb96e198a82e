"""The import of files of this machine into a service elsewhere."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.progress import Progress, TaskID

from app.cli.fit import wait_for
from app.cli.output import print_json, print_table, progress_bar
from app.cli.session import open_client
from app.errors import BadField, Place

if TYPE_CHECKING:
    from kinedex import Kinedex
    from kinedex.types.jobs import Job, JobFile

FAILURE = 1
FAST = 1
"""The level of compression: motion files become small at once."""


def import_to_service(
    context: typer.Context, path: Path, *, wait: bool, as_json: bool, labels: Any = None
) -> None:
    """Upload a folder (as a ZIP), a ZIP or a motion file, and follow the analysis.

    labels: fields of a single motion file, by name. Ends the program with 1 if files failed.
    Raises BadField and kinedex.KinedexError.
    """
    if not path.exists():
        message = f"There is no file or folder {path}."
        raise BadField(message, places=[Place("path", message)])
    with open_client(context) as client:
        job = _upload(client, path, labels or {})
        if job is not None and wait:
            job = wait_for(client, job.id, "analyzing")
        files = _failures(client, job) if job is not None and wait else []
    _print(job, files, as_json=as_json)
    if job is not None and (files or job.state in {"failed", "canceled"}):
        raise typer.Exit(FAILURE)


def _upload(client: Kinedex, path: Path, labels: dict[str, Any]) -> Job | None:
    """The job that analyzes the files; None if the service already had the file."""
    with progress_bar() as bar:
        if path.is_file() and not _is_archive(path):
            task = bar.add_task("uploading", total=path.stat().st_size)
            return client.clips.upload(path, progress=_shows(bar, task), **labels).job
        with _archive_of(path, bar) as archive:
            task = bar.add_task("uploading", total=archive.stat().st_size)
            return client.clips.upload_archive(archive, progress=_shows(bar, task)).job


def _shows(bar: Progress, task: TaskID) -> Any:
    return lambda done, total: bar.update(task, completed=done, total=total)


def _is_archive(path: Path) -> bool:
    return path.suffix.lower() != ".npz" and zipfile.is_zipfile(path)


@contextmanager
def _archive_of(path: Path, bar: Progress) -> Iterator[Path]:
    """The ZIP at `path`, or a temporary ZIP of the folder. Hidden files are left out."""
    if path.is_file():
        yield path
        return
    files = sorted(one for one in path.rglob("*") if one.is_file() and not _is_hidden(one, path))
    with tempfile.TemporaryDirectory(prefix="kinedex-") as folder:
        archive = Path(folder, f"{path.resolve().name or 'import'}.zip")
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=FAST) as zipped:
            for file in bar.track(files, description="packing"):
                zipped.write(file, file.relative_to(path))
        yield archive


def _is_hidden(file: Path, folder: Path) -> bool:
    return any(part.startswith(".") for part in file.relative_to(folder).parts)


def _failures(client: Kinedex, job: Job) -> list[JobFile]:
    if job.kind != "import":
        return []
    return [
        *client.jobs.files(job.id, outcome="failed"),
        *client.jobs.files(job.id, outcome="absent"),
    ]


def _print(job: Job | None, failures: list[JobFile], *, as_json: bool) -> None:
    if job is None:
        if as_json:
            print_json(None)
        else:
            typer.echo("The library already has this file.")
        return
    if as_json:
        print_json(job.to_json())
        return
    result = job.result or {}
    if job.state in {"queued", "processing"}:
        typer.echo(f"{job.id}: uploaded; the service analyzes the clips.")
    elif "total" in result:
        present = result["ready"] + result["exists"]
        new = f"({result['ready']} new)"
        typer.echo(f"{present} of {result['total']} files are in the library {new}.")
    elif job.state == "succeeded":
        typer.echo("The clip is in the library.")
    if failures:
        rows = [(file.path, file.error and _reason(file.error)) for file in failures]
        print_table(("failed", "reason"), rows)
    if job.error is not None:
        typer.echo(f"kinedex: {_reason(job.error)}", err=True)


def _reason(problem: Any) -> str:
    places = [f"{place.location}: {place.message}" for place in problem.errors]
    # the detail of a file reader is often the same text as its only place
    return " ".join([problem.detail, *(place for place in places if place != problem.detail)])
