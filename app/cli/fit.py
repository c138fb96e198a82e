"""The command that fits the models on the library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library

if TYPE_CHECKING:
    from app.store.jobs.record import JobRecord

COUNT_SUFFIX = "clips"
"""Figures whose names end like this are counts, not shares."""


def fit(context: typer.Context, as_json: AsJson = False) -> None:
    """Fit the models on the current library, and show their held-out figures."""
    from app.api.schemas.jobs import Job
    from app.cli.library import FAILURE, follow, working
    from app.services.training import models
    from app.store.jobs.record import JobState

    with open_library(context) as lib:
        request = models.request_fit(lib)
        with working(lib):
            job = follow(lib, request.id, "fitting models")
        fitted = models.list_models(lib)
    if as_json:
        print_json(Job.model_validate(job).model_dump(mode="json"))
    else:
        rows = [
            (model.kind, model.version, model.library_size, name, value)
            for model in fitted
            for name, value in _shares(model.meta.get("figures", {})) or [("", None)]
        ]
        print_table(("model", "version", "clips", "held out", "figure"), rows)
        _print_failures(job)
    if job.state is not JobState.SUCCEEDED:
        raise typer.Exit(FAILURE)


def _print_failures(job: JobRecord) -> None:
    """Print the models that were not fitted with the reasons, and the error of the job."""
    for kind, outcome in (job.result or {}).get("models", {}).items():
        if "reason" in outcome:
            typer.echo(f"{kind}: {outcome['outcome']}: {outcome['reason']}", err=True)
    if job.error:
        typer.echo(f"kinedex: {job.error['detail']}", err=True)


def _shares(figures: Any, path: str = "") -> list[tuple[str, float | None]]:
    """The shares in nested figures, named by their path. Counts are left out.

    path: the names of the dictionaries that contain `figures`, joined by spaces.
    """
    if isinstance(figures, list):
        return [share for one in figures for share in _shares(one, path)]
    if not isinstance(figures, dict):
        is_share = isinstance(figures, float) and not path.endswith(COUNT_SUFFIX)
        return [(path, figures)] if is_share else []
    name = f"{path} {figures.get('method', '')}".strip()
    return [s for key, value in figures.items() for s in _shares(value, f"{name} {key}".strip())]
