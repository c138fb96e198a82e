"""The commands for API keys: create, list, revoke."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated

import typer

from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library
from app.cli.times import LIFE_HELP, time_after
from app.store.key_role import KeyRole

program = typer.Typer(help="Create, list and revoke API keys.", no_args_is_help=True)


@program.command("create")
def create(
    context: typer.Context,
    role: Annotated[KeyRole, typer.Option(help="What the key allows.")] = KeyRole.READ,
    name: Annotated[str, typer.Option(help="The user or program of the key.")] = "",
    source: Annotated[
        str | None,
        typer.Option(help="Only the clips of this source; the role must be read."),
    ] = None,
    expires: Annotated[
        str | None, typer.Option(help=f"When the key ends: {LIFE_HELP} Default: never.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Create a key and show it once; only its hash is stored."""
    from app.services import fields
    from app.store import audit, keys

    end = None if expires is None else time_after(expires, "--expires")
    if end is not None and end <= datetime.now(UTC):
        raise typer.BadParameter(f"{end:%F %T} UTC is over", param_hint="--expires")
    of_source = fields.text("source", source)
    with open_library(context) as lib, lib.store.write() as tx:
        created = keys.create(tx, role, name, source=of_source, expires_at=end)
        audit.note(created_key_id=created.record.id, role=role.value)
    if as_json:
        record = created.record
        print_json(
            {
                "id": record.id,
                "role": record.role.value,
                "source": record.source,
                "expires_at": _text(record.expires_at),
                "key": created.secret,
            }
        )
        return
    typer.echo(created.secret)
    # the note goes to standard error, so that a script reads only the key
    typer.echo(
        "Store the key: it is not shown again. Send it as `Authorization: Bearer ...`.", err=True
    )


@program.command("list")
def list_keys(context: typer.Context, as_json: AsJson = False) -> None:
    """Show the keys, without their secrets, with their last use (to a minute) and their end."""
    from app.store import keys

    with open_library(context) as lib, lib.store.read() as tx:
        records = keys.list_keys(tx)
    documents = [
        {
            "id": record.id,
            "role": record.role.value,
            "name": record.name,
            "source": record.source,
            "created_at": _text(record.created_at),
            "expires_at": _text(record.expires_at),
            "used_at": _text(record.used_at),
            "revoked_at": _text(record.revoked_at),
        }
        for record in records
    ]
    if as_json:
        print_json(documents)
        return
    columns = ("id", "role", "name", "source", "created", "expires", "used", "revoked")
    table = [
        (
            record.id,
            record.role.value,
            record.name,
            record.source,
            _short(record.created_at),
            _short(record.expires_at),
            _short(record.used_at),
            _short(record.revoked_at),
        )
        for record in records
    ]
    print_table(columns, table)


@program.command("revoke")
def revoke(context: typer.Context, key_id: str) -> None:
    """Revoke a key, so that the API no longer accepts it."""
    from app.store import audit, keys

    with open_library(context) as lib, lib.store.write() as tx:
        keys.revoke(tx, key_id)
        audit.note(revoked_key_id=key_id)
    typer.echo(f"Key {key_id} is revoked.")


def _text(time: datetime | None) -> str | None:
    return None if time is None else time.isoformat()


def _short(time: datetime | None) -> str | None:
    return None if time is None else f"{time:%F %H:%M}"
