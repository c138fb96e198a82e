"""The commands that run the service: API and worker."""

from __future__ import annotations

import signal
import threading
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.settings import refuse_missing_library, settings_of

if TYPE_CHECKING:
    from app.config import Settings

UNHEALTHY = 1
"""The exit code of a check that failed."""

Host = Annotated[str | None, typer.Option(help="Address to listen on [KINEDEX_HOST].")]
Port = Annotated[int | None, typer.Option(help="Port to listen on [KINEDEX_PORT].")]
Processes = Annotated[
    int | None,
    typer.Option(help="Processes of the API, which share the port [KINEDEX_PROCESSES]."),
]
RootPath = Annotated[
    str | None,
    typer.Option(help="Path below which a reverse proxy shows it [KINEDEX_ROOT_PATH]."),
]


def serve(
    context: typer.Context,
    host: Host = None,
    port: Port = None,
    root_path: RootPath = None,
    processes: Processes = None,
    with_worker: Annotated[
        bool, typer.Option("--worker/--no-worker", help="Whether to run a worker too.")
    ] = True,
) -> None:
    """Run the API and a worker until you stop them; a process that dies is restarted."""
    from app.logs import configure_logging
    from app.services.exposure import refuse_exposure_without_keys, refuse_taken_address
    from app.store import identity
    from app.worker.supervisor import supervise

    settings = settings_of(context, host=host, port=port, root_path=root_path, processes=processes)
    configure_logging(settings.log_level.upper())
    identity.prepare(settings.database, settings.files_place)
    refuse_exposure_without_keys(settings)
    refuse_taken_address(settings)
    raise typer.Exit(supervise(settings, with_worker))


def worker(
    context: typer.Context,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Only check that a worker runs on this machine and that none hangs; the exit "
            "code is 1 if not.",
        ),
    ] = False,
) -> None:
    """Do the queued work until you stop it; several workers can share one library."""
    if check:
        _check_workers(settings_of(context))
        return
    from app.json_stderr import json_stderr
    from app.logs import set_level
    from app.worker.loop import run_worker

    settings = settings_of(context)
    refuse_missing_library(settings, "worker")
    stop = threading.Event()
    # a worker that is stopped finishes or returns its job before it exits
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    with json_stderr():
        set_level(settings.log_level.upper())
        run_worker(settings, stop)


def _check_workers(settings: Settings) -> None:
    """Check the workers of this machine, in a container those of this container.

    It reads only their heartbeats, so it also works while the database is locked. A heartbeat is
    too old after the time in which a job would go to another worker.
    """
    from app.store import workers

    here = [worker for worker in workers.living(settings.files_dir) if worker.is_here]
    for worker in here:
        typer.echo(f"{worker.owner}: last heartbeat {worker.age_s:.1f} s ago")
    if not here:
        typer.echo("kinedex: no worker runs here.", err=True)
        raise typer.Exit(UNHEALTHY)
    if any(worker.age_s >= settings.job_lease_s for worker in here):
        message = f"kinedex: a worker hangs: no heartbeat for {settings.job_lease_s:g} s."
        typer.echo(message, err=True)
        raise typer.Exit(UNHEALTHY)
