"""`/metrics` for Prometheus: requests by route and status, and the state of the library.

`docker/README.md` lists all metrics.
"""

from __future__ import annotations

from fastapi import FastAPI
from fastapi.responses import PlainTextResponse
from prometheus_client import CollectorRegistry, ProcessCollector
from prometheus_fastapi_instrumentator import Instrumentator

from app.api.deps import reads
from app.api.guard.admission import quick
from app.api.library_metrics import LibraryMetrics
from app.api.openapi import refusals


def install_metrics(app: FastAPI) -> None:
    """Count and time every request. Each application has its own registry."""
    # In the global registry, two applications of one process would share their counters.
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    registry.register(LibraryMetrics(lambda: app.state.library))
    instrumentator = Instrumentator(
        registry=registry, excluded_handlers=["/metrics", "/livez", "/readyz"]
    )
    instrumentator.instrument(app)
    instrumentator.expose(
        app,
        tags=["service"],
        dependencies=[reads, quick],
        response_class=PlainTextResponse,
        responses={status: refusals()[status] for status in (401, 403, 503)},
    )
