"""The command that fits the models on the library."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import nullcontext
from typing import TYPE_CHECKING

import typer

from app.cli.figures import main_figure, shares
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table, progress_bar
from app.cli.session import open_client
from app.cli.settings import remote_of, settings_of

if TYPE_CHECKING:
    from kinedex import Kinedex
    from kinedex.types.jobs import Job
    from kinedex.types.models import Model

FAILURE = 1
PROGRESS_STEPS = 1000
COLUMNS = ("model", "version", "clips", "held out", "figure")


def fit(context: typer.Context, as_json: AsJson = False, as_csv: AsCsv = False) -> None:
    """Fit the models on the current library, and show their held-out figures."""
    from app.cli.working import working_on

    is_local = remote_of(context) is None
    with open_client(context) as client:
        started = client.models.fit().job
        with working_on(settings_of(context)) if is_local else nullcontext():
            job = wait_for(client, started.id, "fitting models")
        models = client.models.list()
    if as_json:
        print_json(job.to_json())
    elif as_csv:
        print_csv(COLUMNS, (dict(zip(COLUMNS, row, strict=True)) for row in _all_rows(models)))
    else:
        print_table(COLUMNS, [_main_row(model) for model in models])
        typer.echo("\nA figure for each model; --json and --csv have all of them.")
        _print_failures(job)
    if job.state != "succeeded":
        raise typer.Exit(FAILURE)


def _all_rows(models: Iterable[Model]) -> list[tuple[object, ...]]:
    """A row for each figure of each model; a model without figures has one row."""
    return [
        (model.kind, model.version, model.library_size, name, value)
        for model in models
        for name, value in shares(model.figures) or [("", None)]
    ]


def _main_row(model: Model) -> tuple[object, ...]:
    name, value = main_figure(model.kind, model.figures)
    return model.kind, model.version, model.library_size, name, value


def wait_for(client: Kinedex, job_id: str, label: str) -> Job:
    """Wait for the end of a job, with a progress bar; label: the text beside the bar."""
    with progress_bar() as bar:
        task = bar.add_task(label, total=PROGRESS_STEPS)

        def show(job: Job) -> None:
            bar.update(task, completed=round(job.progress * PROGRESS_STEPS))

        return client.jobs.wait(job_id, on_progress=show, check=False)


def _print_failures(job: Job) -> None:
    """Print the models that were not fitted with the reasons, and the error of the job."""
    for kind, outcome in (job.result or {}).get("models", {}).items():
        if "reason" in outcome:
            typer.echo(f"{kind}: {outcome['outcome']}: {outcome['reason']}", err=True)
    if job.error is not None:
        typer.echo(f"kinedex: {job.error.detail}", err=True)
