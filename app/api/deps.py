"""Dependencies of the routes: the library, and an API key that allows the call.

Roles: `read` for calls that only read (searches and recognition too), `write` for calls that
store, change or fit something, `admin` for all calls. Calls need no key while no key exists and
the service listens on loopback only. Pages, `/livez`, `/readyz`, `/docs`, `/v1/session` and
`/openapi.json` never need a key, because they show nothing of the library. `/metrics` needs `read`.
"""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import APIKeyHeader, HTTPAuthorizationCredentials, HTTPBearer

from app.api.failures.problems import NotReadyYet
from app.api.guard.callers import Caller
from app.services.library.library import Library
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
    """A dependency: it checks that the caller's key has at least this role."""

    def __init__(self, role: KeyRole) -> None:
        self.role = role

    async def __call__(
        self,
        request: Request,
        # `AccessCheck` reads these headers. They are here only for the OpenAPI description.
        _bearer: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
        _header: Annotated[str | None, Depends(_header)],
    ) -> None:
        """Raises Unauthorized without a valid key, Forbidden if the key's role is too low."""
        caller: Caller = request.state.caller
        caller.require(self.role)


reads = Depends(Allows(KeyRole.READ))
writes = Depends(Allows(KeyRole.WRITE))
administers = Depends(Allows(KeyRole.ADMIN))
