"""The command that moves a library to PostgreSQL, and its files to another place."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.backup import exit_on_sigterm
from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import open_store, settings_of

if TYPE_CHECKING:
    from app.store.files.bucket import FilesPlace


def migrate_to(
    context: typer.Context,
    url: Annotated[
        str,
        typer.Argument(
            help="URL of a new PostgreSQL database. Its password may be in the file of PGPASSFILE."
        ),
    ],
    files: Annotated[
        str | None,
        typer.Option(help="A folder, or s3://bucket/prefix, for the files; unset: they stay."),
    ] = None,
    switch: Annotated[
        bool,
        typer.Option("--switch", help="Finish the move: Kinedex must be stopped before."),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Copy the library into a PostgreSQL database, and its files to a bucket, while it is in use.

    Run it again at any time: it goes on where it was, and takes what has changed since. Then stop
    Kinedex and run it with --switch. It compares all rows and files again, and says how to start.
    KINEDEX_FILES_ENDPOINT, _REGION, _ACCESS_KEY, _SECRET_KEY and _KEYS_FILE say how to reach the
    bucket.
    """
    from dataclasses import asdict

    from app.store.files.places import open_files
    from app.store.upkeep.move import move, open_target

    place = None if files is None else _place(context, files)
    target = open_target(url)
    try:
        with open_store(context) as store, exit_on_sigterm(), progress_bar() as bar:
            task = bar.add_task("copying", total=None)
            done = move(
                store,
                target,
                None if place is None else open_files(place, store.files.library_id),
                switch=switch,
                progress=lambda what, n, total: bar.update(
                    task, description=what, completed=n, total=total
                ),
            )
    finally:
        target.close()
    if as_json:
        print_json(asdict(done))
        return
    typer.echo(
        f"{done.rows} rows are the same in both databases ({done.written} were written now,"
        f" {done.removed} removed). {done.files} files, of which {done.copied} were copied now."
    )
    typer.echo(_next(files) if switch else "Next: stop Kinedex, and run this again with --switch.")


def _next(files: str | None) -> str:
    where = (
        ""
        if files is None
        else f", KINEDEX_FILES_URL={files}"
        if "://" in files
        else (f", and KINEDEX_DATA_DIR to the folder that holds {files}")
    )
    return f"Start Kinedex with KINEDEX_DATABASE_URL set to the new database{where}."


def _place(context: typer.Context, files: str) -> FilesPlace:
    if "://" not in files:
        return Path(files)
    settings = settings_of(context, files_url=files)
    return settings.files_at(settings.data_dir / "moving")
