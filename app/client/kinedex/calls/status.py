"""Calls: status. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.call import Call, record
from kinedex.types.status import Status


def get_status() -> Call[Status]:
    """What the library holds, what waits, and how full its disk is."""
    return Call("get_status", "GET", "/v1/status", record(Status))
