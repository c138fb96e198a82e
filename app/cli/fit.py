"""Fit the models on the library as it is now."""

from __future__ import annotations

import typer

from app.cli.library import FAILURE, follow, working
from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library
from app.services import models
from app.store.job_record import JobState


def fit(context: typer.Context, as_json: AsJson = False) -> None:
    """Fit the models on the library as it is now, and show their held-out figures."""
    with open_library(context) as lib:
        asked = models.request_fit(lib)
        with working(lib):
            job = follow(lib, asked.id, "fitting models")
        fitted = models.list_models(lib)
    if as_json:
        print_json({"result": job.result, "error": job.error})
    else:
        rows = [
            (model.kind, model.version, model.library_size, name, value)
            for model in fitted
            for name, value in model.meta.get("figures", {}).items()
            if isinstance(value, int | float)
        ]
        print_table(("model", "version", "clips", "held out", "figure"), rows)
    if job.state is not JobState.SUCCEEDED:
        raise typer.Exit(FAILURE)
