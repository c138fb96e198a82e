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

from app.cli import import_report
from app.cli.fit import wait_for
from app.cli.output import print_json, progress_bar
from app.cli.session import open_client
from app.errors import BadField
from app.kinedex_error import Place
from app.services.imports.folders import content_of

if TYPE_CHECKING:
    from kinedex import Kinedex
    from kinedex.types.jobs import Job

FAST = 1
"""The level of compression: motion files become small at once."""


def import_to_service(
    context: typer.Context, path: Path, *, wait: bool, as_json: bool, given: dict[str, Any]
) -> None:
    """Upload a folder (as a ZIP), a ZIP or a motion file, and follow the analysis.

    given: values of labels by name, `labels` (a pattern of paths) and `overwrite`; None is not
    sent. Ends the program with 1 if files failed, and with 2 if no file could be imported. Raises
    BadField and kinedex.KinedexError.
    """
    if not path.exists():
        message = f"There is no file or folder {path}."
        raise BadField(message, places=[Place("path", message)])
    with open_client(context) as client:
        job = _upload(client, path, {name: one for name, one in given.items() if one is not None})
        if job is not None and wait:
            job = wait_for(client, job.id, "analyzing")
        _print(client, job, as_json=as_json)
    if job is not None and (code := _exit_code(job)):
        raise typer.Exit(code)


def _upload(client: Kinedex, path: Path, given: dict[str, Any]) -> Job | None:
    """The job that analyzes the files; None if the service already had the file."""
    with progress_bar() as bar:
        if path.is_file() and not _is_archive(path):
            task = bar.add_task("uploading", total=path.stat().st_size)
            fields = _of_one_file(path, given)
            return client.clips.upload(path, progress=_shows(bar, task), **fields).job
        with _archive_of(path, bar) as archive:
            task = bar.add_task("uploading", total=archive.stat().st_size)
            return client.clips.upload_archive(archive, progress=_shows(bar, task), **given).job


def _of_one_file(path: Path, given: dict[str, Any]) -> dict[str, Any]:
    """The fields of the upload of one file, whose path has no folders that could be labels."""
    from app.services.imports.skeleton_pairs import skeleton_beside

    fields = {name: value for name, value in given.items() if name not in ("labels", "overwrite")}
    skeleton = skeleton_beside(path)
    if skeleton is not None:
        fields["skeleton"] = skeleton
    return fields | {"on_conflict": "update" if given.get("overwrite") else "keep"}


def _shows(bar: Progress, task: TaskID) -> Any:
    return lambda done, total: bar.update(task, completed=done, total=total)


def _is_archive(path: Path) -> bool:
    return path.suffix.lower() != ".npz" and zipfile.is_zipfile(path)


@contextmanager
def _archive_of(path: Path, bar: Progress) -> Iterator[Path]:
    """The ZIP at `path`, or a temporary ZIP of the files that `content_of` finds."""
    if path.is_file():
        yield path
        return
    content = content_of(path)
    for library in content.libraries:
        typer.echo(f"{library} is left out: it is a library of Kinedex.", err=True)
    with tempfile.TemporaryDirectory(prefix="kinedex-") as folder:
        archive = Path(folder, f"{path.resolve().name or 'import'}.zip")
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=FAST) as zipped:
            for file in bar.track(content.files, description="packing"):
                if file.is_file():
                    zipped.write(file, file.relative_to(path))
        yield archive


def _print(client: Kinedex, job: Job | None, *, as_json: bool) -> None:
    if job is None:
        if as_json:
            print_json(None)
        else:
            typer.echo("The library already has this file.")
        return
    files = import_report.remote_files(client, job.id) if job.kind == "import" else _no_files
    if as_json:
        print_json(import_report.document(job.to_json(), files))
    elif job.state in {"queued", "processing"}:
        typer.echo(f"{job.id}: uploaded; the service analyzes the clips.")
    elif job.kind == "import":
        import_report.show(job, files)
    elif job.state == "succeeded":
        typer.echo("The clip is in the library.")
    elif job.error is not None:
        typer.echo(f"kinedex: {job.error.detail}", err=True)


def _no_files(_outcome: str | None) -> list[Any]:
    return []


def _exit_code(job: Job) -> int:
    if job.kind == "import":
        return import_report.exit_code(job)
    return import_report.FAILED if job.state in {"failed", "canceled"} else 0
