"""The demo: a library of generated motions, ingested and served."""

from __future__ import annotations

import tempfile
import threading
import urllib.error
import urllib.request
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from app.cli.serve import Host, Port
from app.cli.settings import open_library, settings_of
from app.logs import configure_logging

if TYPE_CHECKING:
    from app.config import Settings

READY_POLL_S = 0.25
READY_TIMEOUT_S = 2
LOG_LEVEL = "WARNING"
"""The log level of the demo. A person reads its output, so it shows no routine log lines."""


def demo(context: typer.Context, host: Host = None, port: Port = None) -> None:
    """Generate the demo library, import it, serve it, and print its address.

    A second run serves the existing library and skips the clips that it already has.
    """
    from app.services.exposure import refuse_exposure_without_keys, refuse_taken_address
    from app.worker.supervisor import supervise

    settings = settings_of(context, host=host, port=port)
    configure_logging(LOG_LEVEL)
    refuse_exposure_without_keys(settings)
    refuse_taken_address(settings)
    _import_demo(context)
    announcer = threading.Thread(target=_print_url_when_ready, args=(settings,), daemon=True)
    announcer.start()
    # the child processes read their log level from the settings
    quiet_settings = settings.model_copy(update={"log_level": LOG_LEVEL.lower()})
    raise typer.Exit(supervise(quiet_settings))


def _import_demo(context: typer.Context) -> None:
    """Generate the demo clips into a temporary folder, import them, and fit the models."""
    from app.cli.library import fit_if_due, follow, register, working
    from app.demo.library import write_demo
    from app.services.examples import add_examples

    with open_library(context) as lib, tempfile.TemporaryDirectory() as folder:
        count = write_demo(Path(folder))
        typer.echo(f"The demo library: {count} clips, generated on this machine.")
        job = register(lib, Path(folder))
        with working(lib):
            follow(lib, job.id, "analyzing")
            fit_if_due(lib)
        add_examples(lib)


def _print_url_when_ready(settings: Settings) -> None:
    """Print the URL once the service can answer searches."""
    url = f"http://{settings.host}:{settings.port}"
    pause = threading.Event()
    while not _is_ready(f"{url}/readyz"):
        pause.wait(READY_POLL_S)
    typer.echo(f"Kinedex is ready at {url} (Ctrl-C stops it).")


def _is_ready(url: str) -> bool:
    try:
        with urllib.request.urlopen(url, timeout=READY_TIMEOUT_S):  # noqa: S310 - our own address
            return True
    except (urllib.error.URLError, OSError):
        return False
