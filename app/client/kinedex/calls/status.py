"""Calls: status. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, record

if TYPE_CHECKING:
    from kinedex.types.status import Status


def get_status() -> Call[Status]:
    """What the library holds, what waits, and how full its disk is."""
    from kinedex.types.status import Status

    return Call("get_status", "GET", "/v1/status", record(Status))
