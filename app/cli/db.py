"""The commands for the database."""

from __future__ import annotations

import typer

from app.cli.settings import settings_of

program = typer.Typer(help="The database.", no_args_is_help=True)


@program.command("upgrade")
def upgrade(context: typer.Context) -> None:
    """Upgrade the database to the schema of this version, or create it."""
    from app.store import identity
    from app.store.database import schema
    from app.store.folders import make_private

    settings = settings_of(context)
    make_private(settings.data_dir)
    identity.refuse_files_without_database(settings.database, settings.files_dir)
    state = schema.upgrade(settings.database)
    typer.echo(f"The database is at revision {state.current}.")


@program.command("adopt-files")
def adopt_files(context: typer.Context) -> None:
    """Confirm that the folder of files belongs to the database, if Kinedex refuses to start.

    Run it only when you are sure. Files that the database does not name are moved to the
    quarantine by the next worker, and are removed after the retention.
    """
    from app.store import identity

    settings = settings_of(context)
    found = identity.adopt(settings.database, settings.files_dir)
    typer.echo(
        f"{settings.files_dir} now belongs to this database. Of the files that it names, "
        f"{found.present} are there and {found.missing} are missing; {found.unknown} others go "
        "to the quarantine."
    )
