"""The command that shows the state of the library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import typer

from app.cli.figures import main_figure
from app.cli.jobs import duration_text
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.models import Model, ModelList
    from kinedex.types.status import QueueStatus, Status

GIB = 2**30
CLIP_STATES = ("ready", "queued", "processing", "failed")


def status(context: typer.Context, as_json: AsJson = False, as_csv: AsCsv = False) -> None:
    """Show what the library holds, what waits, the models, and the disk."""
    with open_client(context) as client:
        found, models = client.service.status(), client.models.list()
    if as_json:
        print_json({**found.to_json(), "models": models.to_json()})
    elif as_csv:
        print_csv(("name", "value"), _lines(found, models))
    else:
        _print_status(found, models)


def _print_status(found: Status, models: ModelList) -> None:
    total = sum(found.clips.values())
    states = [f"{found.clips.get(s, 0)} {s}" for s in CLIP_STATES if found.clips.get(s)]
    free, size = found.disk.free / GIB, found.disk.total / GIB
    rows = [
        ("version", f"Kinedex {found.version}, library version {found.library_version}"),
        ("clips", f"{total}{': ' if states else ''}{', '.join(states)}"),
        ("queue", _queue_text(found.jobs)),
        ("disk", f"{free:.1f} GiB free of {size:.1f} GiB"),
    ]
    print_table(("", ""), rows)
    if models.items:
        columns = ("model", "version", "clips", "age", "held out", "figure")
        print_table(columns, [_model_row(model) for model in models])
    for one in models.unfitted:
        typer.echo(f"{one.kind}: {one.outcome}: {one.reason}")


def _queue_text(jobs: Sequence[QueueStatus]) -> str:
    if not jobs:
        return "no open jobs"
    parts = [f"{one.count} {one.kind} {one.state}" for one in jobs]
    oldest = max(one.oldest_s for one in jobs)
    return f"{', '.join(parts)}; the oldest is {duration_text(oldest)} old"


def _model_row(model: Model) -> tuple[object, ...]:
    name, figure = main_figure(model.kind, model.figures)
    age = duration_text((datetime.now(UTC) - model.created_at).total_seconds())
    return model.kind, model.version, model.library_size, age, name, figure


def _lines(found: Status, models: ModelList) -> list[Mapping[str, Any]]:
    """The status as names and values."""
    values: dict[str, Any] = {"version": found.version, "library_version": found.library_version}
    values |= {f"clips.{state}": count for state, count in found.clips.items()}
    for job in found.jobs:
        values |= {f"jobs.{job.kind}.{job.state}": job.count}
        values |= {f"jobs.{job.kind}.{job.state}.oldest_s": round(job.oldest_s, 3)}
    values |= {"disk.free": found.disk.free, "disk.total": found.disk.total}
    for model in models:
        values |= {f"models.{model.kind}.version": model.version}
        values |= {f"models.{model.kind}.created_at": model.to_json()["created_at"]}
        values |= {f"models.{model.kind}.library_size": model.library_size}
    return [{"name": name, "value": value} for name, value in values.items()]
