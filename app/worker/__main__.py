"""`python -m app.worker`: one worker process, until SIGTERM or SIGINT."""

from __future__ import annotations

import logging
import signal
import sys
import threading

from app.config import load_settings
from app.json_stderr import json_stderr
from app.logs import set_level
from app.services.exposure import CANNOT_START, START_FAILURES
from app.worker.loop import run_worker

log = logging.getLogger(__name__)


def main() -> int:
    """Work until a signal; returns 0, or CANNOT_START if settings or database do not allow it."""
    stop = threading.Event()
    for sign in (signal.SIGTERM, signal.SIGINT):
        signal.signal(sign, lambda *_: stop.set())
    with json_stderr():
        try:
            settings = load_settings()
            set_level(settings.log_level.upper())
            run_worker(settings, stop)
        except START_FAILURES as problem:
            log.critical("the worker cannot start: %s", problem.detail)
            return CANNOT_START
    return 0


if __name__ == "__main__":
    sys.exit(main())
