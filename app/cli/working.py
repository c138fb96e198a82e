"""A worker inside the process of a command."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.config import Settings


@contextmanager
def working_on(settings: Settings) -> Iterator[None]:
    """Run a worker in a thread; it shares the queue with workers of other processes."""
    from app.worker.loop import run_worker

    stop = threading.Event()
    worker = threading.Thread(target=run_worker, args=(settings, stop), name="worker")
    worker.start()
    try:
        yield
    finally:
        stop.set()
        worker.join()
