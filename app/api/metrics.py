"""`/metrics` for Prometheus: requests by route and status, and the state of the library.

Several processes of the API count together, in files of the folder PROMETHEUS_MULTIPROC_DIR
(prometheus_client's multiprocess mode): any of them shows the sums, also of processes that have
died. What describes one process then has a label with its number. `docker/README.md` lists all
metrics.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import PlainTextResponse
from prometheus_client import CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.core import Metric
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import Collector
from prometheus_fastapi_instrumentator import Instrumentator

from app.api.deps import reads
from app.api.guard.admission import quick
from app.api.library_metrics import LibraryMetrics
from app.api.openapi import refusals

SHARED_DIR = "PROMETHEUS_MULTIPROC_DIR"
_PARENT = 1
"""The place of the parent's number among the fields after the name in /proc/PID/stat (proc(5))."""


def install_metrics(app: FastAPI) -> None:
    """Count and time every request. Each application has its own registry."""
    # In the global registry, two applications of one process would share their counters.
    counted = CollectorRegistry()
    folder = os.environ.get(SHARED_DIR)
    shown = counted
    if folder is None:
        ProcessCollector(registry=shown)
    else:
        shown = CollectorRegistry()
        MultiProcessCollector(shown, folder)  # type: ignore[no-untyped-call]
        shown.register(_Siblings(Path(folder)))
    shown.register(LibraryMetrics(lambda: app.state.library))
    Instrumentator(
        registry=counted, excluded_handlers=["/metrics", "/livez", "/readyz"]
    ).instrument(app)

    @app.get(
        "/metrics",
        tags=["service"],
        dependencies=[reads, quick],
        response_class=PlainTextResponse,
        responses={status: refusals()[status] for status in (401, 403, 503)},
    )
    def metrics() -> PlainTextResponse:
        """Endpoint that serves Prometheus metrics."""
        return PlainTextResponse(generate_latest(shown), media_type=CONTENT_TYPE_LATEST)


class _Siblings(Collector):
    """The metrics of each process of the API, with a label of its number."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def collect(self) -> Iterable[Metric]:
        """The metrics by name, with samples of all living processes."""
        found: dict[str, Metric] = {}
        for pid in _living(self._folder):
            own = ProcessCollector(pid=lambda pid=pid: pid, registry=None)  # type: ignore[misc]
            for metric in own.collect():
                merged = found.setdefault(
                    metric.name, Metric(metric.name, metric.documentation, metric.type)
                )
                for sample in metric.samples:
                    labels = {**sample.labels, "pid": str(pid)}
                    merged.add_sample(sample.name, labels, sample.value)
        return found.values()


def _living(folder: Path) -> list[int]:
    """The numbers of the living processes that count in the folder: those of the same parent."""
    numbers = {path.stem.rpartition("_")[2] for path in folder.glob("*.db")}
    return sorted(int(number) for number in numbers if _parent_of(number) == os.getppid())


def _parent_of(number: str) -> int | None:
    """The parent of a process; None if it has ended."""
    try:
        fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return int(fields[_PARENT])
