"""The commands for API keys: create, list, revoke."""

from __future__ import annotations

from typing import Annotated

import typer

from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library
from app.store.key_role import KeyRole

program = typer.Typer(help="Create, list and revoke API keys.", no_args_is_help=True)


@program.command("create")
def create(
    context: typer.Context,
    role: Annotated[KeyRole, typer.Option(help="What the key allows.")] = KeyRole.READ,
    name: Annotated[str, typer.Option(help="The user or program of the key.")] = "",
    as_json: AsJson = False,
) -> None:
    """Create a key and show it once; only its hash is stored."""
    from app.store import keys

    with open_library(context) as lib, lib.store.write() as tx:
        created = keys.create(tx, role, name)
    if as_json:
        record = created.record
        print_json({"id": record.id, "role": record.role.value, "key": created.secret})
        return
    typer.echo(created.secret)
    # the note goes to standard error, so that a script reads only the key
    typer.echo(
        "Store the key: it is not shown again. Send it as `Authorization: Bearer ...`.", err=True
    )


@program.command("list")
def list_keys(context: typer.Context, as_json: AsJson = False) -> None:
    """Show the keys, without their secrets."""
    from app.store import keys

    with open_library(context) as lib, lib.store.read() as tx:
        records = keys.list_keys(tx)
    columns = ("id", "role", "name", "created_at", "revoked_at")
    rows = [
        (
            record.id,
            record.role.value,
            record.name,
            record.created_at.isoformat(),
            record.revoked_at.isoformat() if record.revoked_at else None,
        )
        for record in records
    ]
    if as_json:
        print_json([dict(zip(columns, row, strict=True)) for row in rows])
    else:
        print_table(columns, rows)


@program.command("revoke")
def revoke(context: typer.Context, key_id: str) -> None:
    """Revoke a key, so that the API no longer accepts it."""
    from app.store import keys

    with open_library(context) as lib, lib.store.write() as tx:
        keys.revoke(tx, key_id)
    typer.echo(f"Key {key_id} is revoked.")
