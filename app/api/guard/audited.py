"""What the audit log says about a call of the API.

Changes are recorded by the store (`app.store.audit`). A route that hands out a clip's file, an
export or a manifest names the dependency `exported`. It records the call when the answer is
ready, so that a refused call and an answer 304 are no exports. To look at clips in the pages is no
export either.
"""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator

from anyio import to_thread
from fastapi import Depends, Request

from app.api.guard.callers import Caller
from app.errors import StorageError
from app.services.library.library import Library
from app.store import audit
from app.store.audit import Call

log = logging.getLogger(__name__)

CHOICES = ("format", "content")
"""Query parameters of exports that are recorded. Others, as filters, may hold names of persons."""
FIRST_BYTES = "bytes=0-"
"""A player reads a recording in many parts. Only the first of them is recorded."""


def audited_call(request: Request) -> Call:
    """What is known of a call before it runs: its operation, who calls, and the ids in its path."""
    caller: Caller = request.state.caller
    ids = {name: value for name, value in request.path_params.items() if name.endswith("_id")}
    return Call(
        action=request.scope["route"].name,
        key_id=caller.key_id,
        address=caller.address,
        clip_id=ids.pop("clip_id", None),
        details=ids,
    )


async def _record_export(request: Request) -> AsyncIterator[None]:
    yield
    if not request.headers.get("range", FIRST_BYTES).startswith(FIRST_BYTES):
        return
    call = audited_call(request)
    choices = {name: request.query_params.get(name) for name in CHOICES}
    call.details |= {name: value for name, value in choices.items() if value is not None}
    await to_thread.run_sync(_add, request.app.state.library, call)


def _add(library: Library, call: Call) -> None:
    try:
        with library.store.write() as tx:
            audit.add(tx, call)
    except StorageError as problem:
        # With a full disk, an export may be the way to save the clips.
        log.warning("an export was not recorded: %s (%s)", call.action, problem.detail)


exported = Depends(_record_export, scope="function")
