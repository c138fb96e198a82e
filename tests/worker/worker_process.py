"""A worker as a process of its own, which a test can kill."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from app.config import Settings


@contextmanager
def worker_process(settings: Settings) -> Iterator[subprocess.Popen[bytes]]:
    """A worker over the data directory of `settings`; it is killed at the end of the block."""
    environ = os.environ | {
        "KINEDEX_DATA_DIR": str(settings.data_dir),
        "KINEDEX_DATABASE_URL": settings.database,
        "KINEDEX_JOB_LEASE_S": str(settings.job_lease_s),
        "KINEDEX_JOB_HEARTBEAT_S": str(settings.job_heartbeat_s),
        "KINEDEX_ANALYSIS_PROCESSES": str(settings.analysis_processes),
        "KINEDEX_LOG_LEVEL": "error",
    }
    process = subprocess.Popen([sys.executable, "-m", "app.worker"], env=environ)
    try:
        yield process
    finally:
        process.kill()
        process.wait()
