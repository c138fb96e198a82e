"""Calls: service. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.call import Call, text


def metrics() -> Call[str]:
    """Endpoint that serves Prometheus metrics."""
    return Call("metrics", "GET", "/metrics", text, accept="*/*")
