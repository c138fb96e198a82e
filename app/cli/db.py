"""The database's schema."""

from __future__ import annotations

import typer

from app.cli.settings import settings_of

program = typer.Typer(help="The database.", no_args_is_help=True)


@program.command("upgrade")
def upgrade(context: typer.Context) -> None:
    """Bring the database to this version's schema, making it where there is none."""
    from app.store import schema

    settings = settings_of(context)
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    state = schema.upgrade(settings.database)
    typer.echo(f"The database is at revision {state.current}.")
