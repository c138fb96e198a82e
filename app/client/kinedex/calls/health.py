"""Calls: health. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, record

if TYPE_CHECKING:
    from kinedex.types.health import Alive, Ready


def livez() -> Call[Alive]:
    """Answer, even if all threads are busy. Needs no key."""
    from kinedex.types.health import Alive

    return Call("livez", "GET", "/livez", record(Alive))


def readyz() -> Call[Ready]:
    """Answer 200 while every call can be answered. Needs no key.

    The answer is 503 before the index is loaded, and while the database is damaged, deleted or
    replaced, the folder of files is missing or replaced, or nothing can be written. `errors`
    names every problem. Stored files that are missing or damaged are counted in `warnings`,
    because the answer stays 200: only downloads and new analyses need these files.
    """
    from kinedex.types.health import Ready

    return Call("readyz", "GET", "/readyz", record(Ready))
