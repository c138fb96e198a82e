"""The caller of a request: the holder of an API key, or anyone if keys are not required."""

from __future__ import annotations

from dataclasses import dataclass

from fastapi.security.utils import get_authorization_scheme_param
from starlette.datastructures import Headers

from app.errors import Forbidden, Unauthorized
from app.services.library.library import Library
from app.store import keys
from app.store.database.engine import Tx
from app.store.key_role import KeyRole


@dataclass(frozen=True, slots=True)
class Caller:
    """The caller of one request.

    role, key_id: of the valid key that was sent, None without a valid key; has_key: whether any
    key was sent; is_free: keys are not required, so everything is allowed.
    """

    role: KeyRole | None
    has_key: bool
    is_free: bool
    key_id: str | None = None

    def require_key(self) -> None:
        """Raises Unauthorized if a key is required and the request has no valid key."""
        # A client that sends a key believes that the calls are protected: say that they are not.
        if self.is_free and self.has_key:
            raise Unauthorized("This key is not valid: there are no API keys here. Send none.")
        if not self.is_free and self.role is None:
            raise Unauthorized("This key is not valid." if self.has_key else None)

    def require(self, role: KeyRole) -> None:
        """Raises Unauthorized without a valid key, Forbidden if the key's role is too low."""
        self.require_key()
        if self.role is not None and not self.role.allows(role):
            raise Forbidden(f"This needs a key with the role {role.value}.")


def find_caller(lib: Library, given: str) -> Caller:
    """Find the caller by a key; `given` is empty without a key. Raises StorageError."""
    with lib.store.read() as tx:
        if is_open(lib, tx):
            return Caller(role=None, has_key=bool(given), is_free=True)
        key = keys.verify(tx, given) if given else None
    if key is None:
        return Caller(role=None, has_key=bool(given), is_free=False)
    return Caller(role=key.role, has_key=True, is_free=False, key_id=key.id)


def is_open(lib: Library, tx: Tx) -> bool:
    """Whether calls need no key: no key was ever created, and only this machine can call."""
    # A revoked key counts too: revoking the last key must not make the API open.
    settings = lib.settings
    local = settings.listens_on_loopback and not settings.require_keys
    return local and not keys.is_any(tx)


def given_key(headers: Headers) -> str:
    """The key in the headers of a request; empty if there is none."""
    scheme, bearer = get_authorization_scheme_param(headers.get("authorization"))
    if scheme.lower() == "bearer" and bearer:
        return bearer
    return headers.get("x-api-key", "")
