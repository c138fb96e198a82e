"""`/metrics`: requests by route and status, for Prometheus."""

from __future__ import annotations

from fastapi import FastAPI
from fastapi.responses import PlainTextResponse
from prometheus_client import CollectorRegistry
from prometheus_fastapi_instrumentator import Instrumentator

from app.api.deps import reads
from app.api.guard.admission import quick
from app.api.openapi import refusals


def install_metrics(app: FastAPI) -> None:
    """Count and time every request. Each application has its own registry."""
    # In the global registry, two applications of one process would share their counters.
    registry = CollectorRegistry()
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
