"""Dependencies of the routes: the library, and an API key that allows the call.

Roles: `read` for calls that only read (searches and recognition too), `write` for calls that
store, change or fit something, `admin` for all calls. A key for one source may make only the calls
of `reads_source`, and sees only the clips of its source. Calls need no key while no key exists and
the service listens on loopback only. Pages, `/livez`, `/readyz`, `/docs`, `/v1/session` and
`/openapi.json` never need a key, because they show nothing of the library. `/metrics` needs `read`.
"""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import APIKeyHeader, HTTPAuthorizationCredentials, HTTPBearer

from app.api.failures.problems import NotReadyYet
from app.api.guard.audited import audited_call
from app.api.guard.callers import Caller
from app.errors import Forbidden
from app.services.library.library import Library
from app.store import audit
from app.store.clips import visibility
from app.store.clips.license_policy import only_licenses
from app.store.key_role import KeyRole

_bearer = HTTPBearer(auto_error=False, description="An API key (`kinedex keys create`).")
_header = APIKeyHeader(name="X-API-Key", auto_error=False, description="The same key.")


async def get_library(request: Request) -> Library:
    """Return the open library. Raises NotReadyYet until the application has opened it.

    The function is async although it awaits nothing: FastAPI would run it in a thread otherwise.
    """
    library: Library | None = getattr(request.app.state, "library", None)
    if library is None:
        raise NotReadyYet
    return library


Lib = Annotated[Library, Depends(get_library)]


class Allows:
    """A dependency: it checks that the caller's key has at least this role.

    A change by the route is recorded in the audit log. is_of_source: whether a key for one source
    may call the route; then the store shows only the clips of this source (`clips.visibility`).
    """

    def __init__(self, role: KeyRole, *, is_of_source: bool = False) -> None:
        self.role = role
        self.is_of_source = is_of_source

    async def __call__(
        self,
        request: Request,
        # `AccessCheck` reads these headers. They are here only for the OpenAPI description.
        _bearer: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
        _header: Annotated[str | None, Depends(_header)],
    ) -> AsyncIterator[None]:
        """Raises Unauthorized without a valid key, Forbidden if the key does not allow the call."""
        caller: Caller = request.state.caller
        caller.require(self.role)
        allowed = request.app.state.settings.allowed_licenses
        if caller.source is not None and not self.is_of_source:
            raise Forbidden("A key for one source only lists, reads, finds and exports its clips.")
        if self.role is not KeyRole.READ and request.method != "GET":
            with audit.calling(audited_call(request)), only_licenses(allowed):
                yield
        else:
            with visibility.only_source(caller.source), only_licenses(allowed):
                yield


# A streamed answer reads clips after its route has returned, so these end with the request.
reads = Depends(Allows(KeyRole.READ))
reads_source = Depends(Allows(KeyRole.READ, is_of_source=True))
writes = Depends(Allows(KeyRole.WRITE), scope="function")
administers = Depends(Allows(KeyRole.ADMIN), scope="function")
