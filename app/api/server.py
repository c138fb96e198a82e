"""One API process: uvicorn around the application. `python -m app.api.server` runs it alone."""

from __future__ import annotations

import uvicorn

from app.api.app import create_app
from app.config import Settings, load_settings
from app.logs import configure_logging

GRACE_SECONDS = 5
"""How long requests that are being answered may go on after a stop; streams are cut then."""


def run(settings: Settings) -> None:
    """Serve until SIGINT or SIGTERM. Raises ConfigurationError and DatabaseOutOfDate."""
    configure_logging(settings.log_level.upper())
    config = uvicorn.Config(
        create_app(settings),
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=GRACE_SECONDS,
    )
    uvicorn.Server(config).run()


if __name__ == "__main__":
    run(load_settings())
