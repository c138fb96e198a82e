"""The command that shows the audit log."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client
from app.cli.times import TIME_HELP, time_before

COLUMNS = ("at", "action", "key_id", "key_name", "address", "clip_id", "details")


def audit(
    context: typer.Context,
    since: Annotated[str | None, typer.Option(help=f"Not before: {TIME_HELP}")] = None,
    until: Annotated[str | None, typer.Option(help=f"Before: {TIME_HELP}")] = None,
    key: Annotated[str | None, typer.Option(help="Only by the API key with this id.")] = None,
    action: Annotated[
        str | None, typer.Option(help="Only this action, for example delete_clip.")
    ] = None,
    clip: Annotated[str | None, typer.Option(help="Only about the clip with this id.")] = None,
    limit: Annotated[int, typer.Option(help="Largest number of rows; 0 for all.", min=0)] = 50,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Show who changed, exported or forgot what, the newest first."""
    filters: dict[str, Any] = {
        "since": None if since is None else time_before(since, "--since"),
        "until": None if until is None else time_before(until, "--until"),
        "key": key,
        "action": action,
        "clip": clip,
        "limit": limit or None,
    }
    with open_client(context) as client:
        entries = [entry.to_json() for entry in client.service.audit(**filters)]
    if as_json:
        print_json({"items": entries})
    elif as_csv:
        rows = [{**entry, "details": json.dumps(entry["details"])} for entry in entries]
        print_csv(COLUMNS, rows)
    else:
        columns = ("at", "action", "by", "from", "clip_id", "details")
        print_table(columns, [_row(entry) for entry in entries])


def _row(entry: dict[str, Any]) -> tuple[object, ...]:
    by = entry["key_name"] or entry["key_id"]
    details = ", ".join(f"{name}: {_text(value)}" for name, value in entry["details"].items())
    at = entry["at"][:16].replace("T", " ")
    return at, entry["action"], by, entry["address"], entry["clip_id"], details


def _text(value: object) -> str:
    return " ".join(map(str, value)) if isinstance(value, list) else str(value)
