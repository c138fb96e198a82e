"""What routes depend on: the library, and a key that allows the call (DESIGN 12).

Roles: `read` for everything that only reads (searches and recognition too), `write` for
storing, changing and fitting, `admin` for all. While no key exists and the service listens
on loopback only, every call is open. Pages, `/livez`, `/readyz`, `/v1/session` and
`/openapi.json` never need a key, since they tell nothing of the library; `/metrics` needs `read`.
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
    """The library that the application opened. Raises NotReadyYet before that.

    Not waited for anywhere: async, so that no thread is taken for it.
    """
    library: Library | None = getattr(request.app.state, "library", None)
    if library is None:
        raise NotReadyYet
    return library


Lib = Annotated[Library, Depends(get_library)]


class Allows:
    """A dependency: the caller's key has at least this role."""

    def __init__(self, role: KeyRole) -> None:
        self.role = role

    async def __call__(
        self,
        request: Request,
        # `Door` has read these headers; here they are for the description of the API.
        _bearer: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
        _header: Annotated[str | None, Depends(_header)],
    ) -> None:
        """Raises Unauthorized without a valid key, Forbidden where its role is too low."""
        caller: Caller = request.state.caller
        caller.require(self.role)


reads = Depends(Allows(KeyRole.READ))
writes = Depends(Allows(KeyRole.WRITE))
