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
QUIET = "WARNING"
"""The default log level of the demo, since its output is for a person."""


def demo(context: typer.Context, host: Host = None, port: Port = None) -> None:
    """Make the demo library, ingest it, serve it, and print where.

    A second run serves the existing library: clips that it has are skipped.
    """
    from app.services.exposure import refuse_exposure_without_keys, refuse_taken_address
    from app.worker.supervisor import supervise

    settings = settings_of(context, host=host, port=port)
    configure_logging(QUIET)
    refuse_exposure_without_keys(settings)
    refuse_taken_address(settings)
    _fill(context)
    announcer = threading.Thread(target=_announce, args=(settings,), daemon=True)
    announcer.start()
    quiet = settings.model_copy(update={"log_level": QUIET.lower()})
    raise typer.Exit(supervise(quiet))


def _fill(context: typer.Context) -> None:
    from app.cli.library import fit_if_due, follow, register, working
    from app.demo.library import write_demo
    from app.services.examples import add_examples

    with open_library(context) as lib, tempfile.TemporaryDirectory() as folder:
        count = write_demo(Path(folder))
        typer.echo(f"The demo library: {count} clips, generated here.")
        job = register(lib, Path(folder))
        with working(lib):
            follow(lib, job.id, "analysing")
            fit_if_due(lib)
        add_examples(lib)


def _announce(settings: Settings) -> None:
    """Print the URL once the service can answer searches."""
    url = f"http://{settings.host}:{settings.port}"
    pause = threading.Event()
    while not _is_ready(f"{url}/readyz"):
        pause.wait(READY_POLL_S)
    typer.echo(f"Kinedex is ready at {url} (Ctrl-C stops it).")


def _is_ready(url: str) -> bool:
    try:
        with urllib.request.urlopen(url, timeout=2):  # noqa: S310 - our own address
            return True
    except (urllib.error.URLError, OSError):
        return False
