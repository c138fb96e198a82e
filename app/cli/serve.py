"""The commands that run the service: API and worker."""

from __future__ import annotations

import signal
import threading
from typing import Annotated

import typer

from app.cli.settings import refuse_missing_library, settings_of

Host = Annotated[str | None, typer.Option(help="Address to listen on [KINEDEX_HOST].")]
Port = Annotated[int | None, typer.Option(help="Port to listen on [KINEDEX_PORT].")]


def serve(
    context: typer.Context,
    host: Host = None,
    port: Port = None,
    with_worker: Annotated[
        bool, typer.Option("--worker/--no-worker", help="Whether to run a worker too.")
    ] = True,
) -> None:
    """Run the API and a worker until you stop them; a process that dies is restarted."""
    from app.logs import configure_logging
    from app.services.exposure import refuse_exposure_without_keys, refuse_taken_address
    from app.store import identity
    from app.worker.supervisor import supervise

    settings = settings_of(context, host=host, port=port)
    configure_logging(settings.log_level.upper())
    identity.prepare(settings.database, settings.files_dir)
    refuse_exposure_without_keys(settings)
    refuse_taken_address(settings)
    raise typer.Exit(supervise(settings, with_worker))


def worker(context: typer.Context) -> None:
    """Do the queued work until you stop it; several workers can share one library."""
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
