"""The client of a command: of the service at --url, else of the local library in this process.

So a command has one code path, and the same answers and problems in both cases.
"""

from __future__ import annotations

import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

from app.cli.settings import open_library, remote_of
from app.quick_imports import without_collector

if TYPE_CHECKING:
    from kinedex import Kinedex

IN_PROCESS_URL = "http://kinedex"


@contextmanager
def open_client(context: typer.Context) -> Iterator[Kinedex]:
    """The client of a command, closed at the end.

    Raises ConfigurationError if there is neither a service nor a library. The calls raise
    `kinedex.KinedexError`.
    """
    with without_collector():
        from kinedex import Kinedex

    remote = remote_of(context)
    if remote is not None:
        with Kinedex(remote.url, remote.api_key, **_tls(remote.url)) as client:
            yield client
        return
    with without_collector():
        from app.api.in_process import in_process

    with (
        open_library(context) as library,
        in_process(library) as transport,
        Kinedex(IN_PROCESS_URL, transport=transport, timeout=None, trust_env=False) as client,
    ):
        yield client


def _tls(url: str) -> dict[str, Any]:
    """Without TLS, an empty context: to load the certificates takes a tenth of a second."""
    if url.startswith("https:"):
        return {}
    return {"verify": ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)}
