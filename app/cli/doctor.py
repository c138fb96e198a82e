"""The command that looks for problems of an installation, and says what to do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.checks.finding import Care, Finding, Level
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.settings import remote_of
from app.errors import BadField
from app.kinedex_error import Place

FAILURE = 1
COLUMNS = ("check", "level", "found", "advice")


def doctor(
    context: typer.Context,
    quick: Annotated[
        bool, typer.Option("--quick", help="Do not read the contents of files and arrays.")
    ] = False,
    mend: Annotated[bool, typer.Option("--mend", help="Mend what is damaged.")] = False,
    backup: Annotated[
        Path | None,
        typer.Option("--from", help="With --mend: a backup; damaged files are copied from it."),
    ] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Look for problems of the installation, and say what to do; the exit code is then 1.

    This compares every row of the database with every file and array, while the library may be in
    use. With --mend, missing and damaged files come back from a backup (by their SHA-256), damaged
    arrays are computed again by the next worker, and indexes of the database are built again. A
    clip that cannot be mended is marked, and says why. Nothing is deleted.

    With --url, it looks at the service: whether it can be reached, is ready and accepts the key.
    """
    _refuse_contradictions(context, quick, mend, backup)
    findings = list(_findings(context, Care(quick, mend, backup)))
    documents: list[dict[str, Any]] = [asdict(finding) for finding in findings]
    has_problem = any(finding.level is Level.PROBLEM for finding in findings)
    if as_json:
        print_json({"is_healthy": not has_problem, "checks": documents})
    elif as_csv:
        print_csv(COLUMNS, documents)
    else:
        rows = [(f.check, f.level.value, f.found) for f in findings]
        print_table(("check", "", "found"), rows)
        for finding in findings:
            if finding.advice:
                typer.echo(f"{finding.check}: {finding.advice}")
    if has_problem:
        raise typer.Exit(FAILURE)


def _refuse_contradictions(
    context: typer.Context, quick: bool, mend: bool, backup: Path | None
) -> None:
    if mend and remote_of(context) is not None:
        message = "is not possible with --url: run it on the machine of the service"
    elif mend and quick:
        message = "needs the contents: leave --quick out"
    elif backup is not None and not mend:
        raise BadField("from: needs --mend", places=[Place("from", "needs --mend")])
    else:
        return
    raise BadField(f"mend: {message}", places=[Place("mend", message)])


def _findings(context: typer.Context, care: Care) -> Iterator[Finding]:
    remote = remote_of(context)
    if remote is not None:
        from app.cli.checks.service import check_service

        yield from check_service(context)
        return
    from app.cli.checks.local import check_machine

    yield from check_machine(context, care)
