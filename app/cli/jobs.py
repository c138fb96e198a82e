"""The commands for jobs, the work in the background: list, show, cancel."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.jobs import Job

program = typer.Typer(help="List, show and cancel work in the background.", no_args_is_help=True)

COLUMNS = (
    "id",
    "kind",
    "state",
    "progress",
    "detail",
    "created_at",
    "started_at",
    "finished_at",
    "error.code",
    "error.detail",
)
FILE_COLUMNS = ("path", "outcome", "clip_id", "error.code", "error.detail")
JobId = Annotated[str, typer.Argument(help="The id of a job.", metavar="JOB_ID")]


@program.command("list")
def list_jobs(
    context: typer.Context,
    kind: Annotated[str | None, typer.Option(help="ingest, import or fit.")] = None,
    state: Annotated[
        str | None, typer.Option(help="queued, processing, succeeded, failed or canceled.")
    ] = None,
    limit: Annotated[int, typer.Option(help="Largest number of jobs; 0 for all.", min=0)] = 20,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """List jobs, the newest first."""
    filters: Any = {"kind": kind, "state": state, "limit": limit or None}
    with open_client(context) as client:
        jobs = list(client.jobs.list(**filters))
    if as_json:
        print_json({"items": [job.to_json() for job in jobs]})
    elif as_csv:
        print_csv(COLUMNS, (job.to_json() for job in jobs))
    else:
        columns = ("id", "kind", "state", "progress", "age", "detail")
        rows = [(j.id, j.kind, j.state, f"{j.progress:.0%}", age_of(j), _detail(j)) for j in jobs]
        print_table(columns, rows, cut=("detail",))


@program.command("show")
def show(
    context: typer.Context,
    job_id: JobId,
    outcome: Annotated[
        str | None,
        typer.Option(help="With an import: only files with this outcome, for example failed."),
    ] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Show one job; of an import, with the outcome of each file."""
    only: Any = {"outcome": outcome}
    with open_client(context) as client:
        job = client.jobs.get(job_id)
        files = list(client.jobs.files(job_id, **only)) if job.kind == "import" else []
    if as_json:
        document = job.to_json()
        if files and document["result"] is not None:
            document["result"]["files"] = [one.to_json() for one in files]
        print_json(document)
    elif as_csv:
        if job.kind == "import":
            print_csv(FILE_COLUMNS, (one.to_json() for one in files))
        else:
            print_csv(COLUMNS, [job.to_json()])
    else:
        print_table(("", ""), _details(job))
        if files:
            rows = [(f.path, f.outcome, f.error and f.error.detail) for f in files]
            print_table(("path", "outcome", "reason"), rows)


@program.command("cancel")
def cancel(context: typer.Context, job_id: JobId, as_json: AsJson = False) -> None:
    """Cancel a job that has not ended. No clip is deleted."""
    with open_client(context) as client:
        job = client.jobs.get(job_id)
        if job.state not in {"queued", "processing"}:
            raise typer.BadParameter(f"the job {job_id} has ended: it is {job.state}")
        canceled = client.jobs.cancel(job_id) or job
    if as_json:
        print_json(canceled.to_json())
    elif canceled.state == "canceled":
        typer.echo(f"{job_id} is canceled.")
    else:
        typer.echo(f"{job_id} stops soon.")


def age_of(job: Job) -> str:
    """The time since a job was created, as a short text."""
    return duration_text((datetime.now(UTC) - job.created_at).total_seconds())


def duration_text(seconds: float) -> str:
    """A duration in its largest unit, for example "3 h"."""
    for unit, size in (("d", 86_400), ("h", 3_600), ("min", 60)):
        if seconds >= size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(seconds, 0):.0f} s"


def _detail(job: Job) -> str | None:
    return job.detail if job.error is None else job.error.detail


def _details(job: Job) -> list[tuple[str, object]]:
    times = ("created_at", "started_at", "finished_at")
    rows: list[tuple[str, object]] = [
        ("id", job.id),
        ("kind", job.kind),
        ("state", job.state),
        ("progress", f"{job.progress:.0%}"),
        ("detail", job.detail),
    ]
    for name in times:
        at = getattr(job, name)
        rows.append((name.removesuffix("_at"), None if at is None else f"{at:%F %T} UTC"))
    counts = {k: v for k, v in (job.result or {}).items() if isinstance(v, int)}
    rows += list(counts.items())
    if job.error is not None:
        rows.append(("error", job.error.detail))
        rows += [(place.location, place.message) for place in job.error.errors]
    return rows
