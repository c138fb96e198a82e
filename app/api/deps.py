"""What routes depend on: the library, and a key that allows the call (DESIGN 12).

Roles: `read` for everything that only reads (searches and recognition too), `write` for
storing, changing and fitting, `admin` for all. While no key exists and the service listens
on loopback only, every call is open. `/livez`, `/readyz`, `/docs` and `/openapi.json` never
need a key, since they tell nothing of the library; `/metrics` needs `read`.
"""

from __future__ import annotations

from typing import Annotated
from urllib.parse import urlsplit

from fastapi import Depends, Request
from fastapi.security import APIKeyHeader, HTTPAuthorizationCredentials, HTTPBearer

from app.api.problems import NotReadyYet
from app.config import LOOPBACK_HOSTS
from app.errors import Forbidden, Unauthorized
from app.services.library import Library
from app.store import keys
from app.store.engine import Tx
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

    def __call__(
        self,
        request: Request,
        lib: Lib,
        bearer: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
        header: Annotated[str | None, Depends(_header)],
    ) -> None:
        """Raises Unauthorized without a valid key, Forbidden where its role is too low."""
        given = bearer.credentials if bearer is not None else header
        with lib.store.read() as tx:
            if is_open(lib, tx):
                _refuse_other_sites(request)
                return
            key = keys.verify(tx, given) if given else None
        if key is None:
            raise Unauthorized("An API key is needed." if not given else "This key is not valid.")
        if not key.role.allows(self.role):
            raise Forbidden(f"This needs a key with the role {self.role.value}.")


reads = Depends(Allows(KeyRole.READ))
writes = Depends(Allows(KeyRole.WRITE))


def is_open(lib: Library, tx: Tx) -> bool:
    """Whether no key is asked for: none was ever made, and only this machine can call."""
    # A revoked key counts too: revoking the last one must not open the door.
    settings = lib.settings
    local = settings.listens_on_loopback and not settings.require_keys
    return local and not keys.is_any(tx)


def _refuse_other_sites(request: Request) -> None:
    """Without keys, a page of another site in the user's browser must see and change nothing.

    Its origin differs; or its own name was made to point at this machine (DNS rebinding), and
    then the name that it calls us by is not one of loopback's.
    """
    if request.url.hostname not in LOOPBACK_HOSTS:
        raise Forbidden("Without API keys, only this machine's own addresses are answered.")
    origin = request.headers.get("origin")
    if origin is None or request.method in {"GET", "HEAD"}:
        return
    if urlsplit(origin).netloc != request.headers.get("host"):
        raise Forbidden("Calls from another site need an API key.")
