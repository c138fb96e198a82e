"""The command that looks for problems of an installation, and says what to do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import typer

from app.cli.checks.finding import Finding, Level
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.settings import remote_of

FAILURE = 1
COLUMNS = ("check", "level", "found", "advice")


def doctor(context: typer.Context, as_json: AsJson = False, as_csv: AsCsv = False) -> None:
    """Look for problems of the installation, and say what to do; the exit code is then 1.

    With --url, it looks at the service: whether it can be reached, is ready and accepts the key.
    """
    findings = list(_findings(context))
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


def _findings(context: typer.Context) -> Iterator[Finding]:
    remote = remote_of(context)
    if remote is not None:
        from app.cli.checks.service import check_service

        yield from check_service(context)
        return
    from app.cli.checks.local import check_machine

    yield from check_machine(context)
