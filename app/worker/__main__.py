"""`python -m app.worker`: one worker process, until SIGTERM or SIGINT."""

from __future__ import annotations

import signal
import sys
import threading

from app.config import load_settings
from app.logs import configure_logging
from app.services.exposure import CANNOT_START, HOPELESS
from app.worker.loop import run_worker


def main() -> int:
    """Work until told to stop; CANNOT_START where settings or database do not allow it."""
    stop = threading.Event()
    for sign in (signal.SIGTERM, signal.SIGINT):
        signal.signal(sign, lambda *_: stop.set())
    try:
        settings = load_settings()
        configure_logging(settings.log_level.upper())
        run_worker(settings, stop)
    except HOPELESS as problem:
        print(f"kinedex worker: {problem.detail}", file=sys.stderr)
        return CANNOT_START
    return 0


if __name__ == "__main__":
    sys.exit(main())
