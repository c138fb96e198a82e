"""The commands that run the service: API and worker."""

from __future__ import annotations

import signal
import threading
from typing import Annotated

import typer

from app.cli.settings import settings_of

Host = Annotated[str | None, typer.Option(help="Address to listen on [KINEDEX_HOST].")]
Port = Annotated[int | None, typer.Option(help="Port to listen on [KINEDEX_PORT].")]
RootPath = Annotated[
    str | None,
    typer.Option(help="Path below which a reverse proxy shows it [KINEDEX_ROOT_PATH]."),
]


def serve(
    context: typer.Context,
    host: Host = None,
    port: Port = None,
    root_path: RootPath = None,
    with_worker: Annotated[
        bool, typer.Option("--worker/--no-worker", help="Whether to run a worker too.")
    ] = True,
) -> None:
    """Serve the API and do the work, until stopped; each process is restarted if it dies."""
    from app.logs import configure_logging
    from app.services.exposure import refuse_exposure_without_keys, refuse_taken_address
    from app.store import identity
    from app.worker.supervisor import supervise

    settings = settings_of(context, host=host, port=port, root_path=root_path)
    configure_logging(settings.log_level.upper())
    identity.prepare(settings.database, settings.files_dir)
    refuse_exposure_without_keys(settings)
    refuse_taken_address(settings)
    raise typer.Exit(supervise(settings, with_worker))


def worker(context: typer.Context) -> None:
    """Do the queued work, until stopped; any number of workers share one library."""
    from app.json_stderr import json_stderr
    from app.logs import set_level
    from app.worker.loop import run_worker

    settings = settings_of(context)
    stop = threading.Event()
    for sign in (signal.SIGTERM, signal.SIGINT):
        signal.signal(sign, lambda *_: stop.set())
    with json_stderr():
        set_level(settings.log_level.upper())
        run_worker(settings, stop)
