"""The commands for the database."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.settings import refuse_missing_library, settings_of

program = typer.Typer(
    help="Upgrade or restore the database, or connect it to its files.", no_args_is_help=True
)


@program.command("upgrade")
def upgrade(context: typer.Context) -> None:
    """Upgrade the database to the schema of this version, or create it."""
    from app.store import identity
    from app.store.database import schema
    from app.store.folders import make_private

    settings = settings_of(context)
    refuse_missing_library(settings, "upgrade")
    make_private(settings.data_dir)
    identity.refuse_files_without_database(settings.database, settings.files_place)
    state = schema.upgrade(settings.database)
    typer.echo(f"The database is at revision {state.current}.")


@program.command("restore")
def restore(
    context: typer.Context,
    path: Annotated[Path, typer.Argument(help="A folder that `kinedex backup` made.")],
) -> None:
    """Load the dump of a backup into an empty PostgreSQL database.

    KINEDEX_DATABASE_URL names the database, and KINEDEX_DATA_DIR the backup or a copy of it, which
    holds the files; if KINEDEX_FILES_URL names a bucket, they are copied into it. A backup of an
    SQLite library needs no such command: start Kinedex on it.
    """
    from app.store.upkeep.dump import restore as restore_dump
    from app.store.upkeep.move import restore_files_to

    settings = settings_of(context)
    restore_dump(settings.database, path)
    if settings.files_url is not None:
        number = restore_files_to(settings.files_place, path)
        typer.echo(f"The database of {path} is restored, and {number} files are in the bucket.")
        return
    typer.echo(
        f"The database of {path} is restored. Start Kinedex with KINEDEX_DATA_DIR set to {path}, or"
        " to a copy of it; `kinedex verify` compares its files with the database."
    )


@program.command("adopt-files")
def adopt_files(context: typer.Context) -> None:
    """Connect the folder of files to the database, if Kinedex refuses to start.

    Run this command only if you are sure that both belong together. The next worker moves files
    that the database does not name to the quarantine, and deletes them after the retention time.
    """
    from app.store import identity

    settings = settings_of(context)
    adopted = identity.adopt(settings.database, settings.files_place)
    typer.echo(
        f"{settings.files_url or settings.files_dir} now belongs to this database. It names "
        f"{adopted.present} files that exist and {adopted.missing} that are missing. The next "
        f"worker moves {adopted.unknown} other files to the quarantine."
    )
