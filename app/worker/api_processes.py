"""The processes of the API: one, or several that share a listening socket.

Their parent opens the socket and never takes a connection. So a client that connects while one of
them dies or starts waits for another one. No process needs to know what another one was asked: all
state that a client can notice is in the store (`app.store.shared_rows` has what need not survive).
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from app.config import Settings
from app.services.exposure import bound
from app.worker.supervised import SupervisedProcess

API = ("-P", "-m", "app.api.server")
"""Arguments of Python. They name a module, because this layer cannot import the API."""

BACKLOG = 256
"""Connections that the kernel queues until a process accepts them."""
METRICS_DIR = "PROMETHEUS_MULTIPROC_DIR"
"""The variable with the folder in which the processes count together (`app.api.metrics`)."""
BLAS_THREADS = "OPENBLAS_NUM_THREADS"


class ApiProcesses:
    """The processes of the API, which the supervisor runs. Raises ConfigurationError."""

    def __init__(self, settings: Settings) -> None:
        self._count = settings.processes
        self._listener = None if self._count == 1 else bound(settings)
        if self._listener is not None:
            self._listener.listen(BACKLOG)

    @contextmanager
    def all(self) -> Iterator[list[SupervisedProcess]]:
        """The processes, for the block."""
        if self._listener is None:
            yield [SupervisedProcess("api", API)]
            return
        number = self._listener.fileno()
        folder = tempfile.mkdtemp(prefix="kinedex-metrics-")
        variables = {METRICS_DIR: folder, BLAS_THREADS: _threads(self._count)}
        try:
            yield [
                SupervisedProcess(
                    f"api {one}",
                    (*API, "--fd", str(number)),
                    files=(number,),
                    variables=variables,
                )
                for one in range(1, self._count + 1)
            ]
        finally:
            self.close()
            shutil.rmtree(folder, ignore_errors=True)

    def close(self) -> None:
        """Close this process's copy of the socket: when all have closed theirs, none listens."""
        if self._listener is not None:
            self._listener.close()


def _threads(processes: int) -> str:
    """The threads of each process for products of matrices: together, as many as cores."""
    cores = len(os.sched_getaffinity(0))
    return os.environ.get(BLAS_THREADS) or str(max(cores // processes, 1))
