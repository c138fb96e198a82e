"""The caller of a request: the holder of an API key, or anyone if keys are not required."""

from __future__ import annotations

from dataclasses import dataclass

from fastapi.security.utils import get_authorization_scheme_param
from starlette.datastructures import Headers
from starlette.types import Scope

from app.errors import Forbidden, Unauthorized
from app.services.library.library import Library
from app.store import keys
from app.store.database.engine import Tx
from app.store.key_role import KeyRole
from app.store.keys import KeyRecord

MAX_ADDRESS_LENGTH = 64
"""Characters of a client's address. Behind a proxy, a header may hold any text."""


@dataclass(frozen=True, slots=True)
class Caller:
    """The caller of one request.

    has_key: whether any key was sent; is_free: keys are not required, so everything is allowed;
    address: of the client, None for a command on this machine; key: the valid key that was sent.
    """

    has_key: bool
    is_free: bool
    address: str | None = None
    key: KeyRecord | None = None

    @property
    def role(self) -> KeyRole | None:
        """The role of the valid key that was sent."""
        return None if self.key is None else self.key.role

    @property
    def key_id(self) -> str | None:
        """The public id of the valid key that was sent."""
        return None if self.key is None else self.key.id

    @property
    def source(self) -> str | None:
        """The only source whose clips the caller may see; None if all."""
        return None if self.key is None else self.key.source

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


def find_caller(lib: Library, given: str, address: str | None) -> Caller:
    """Find the caller by a key; `given` is empty without a key. Raises StorageError."""
    with lib.store.read() as tx:
        is_free = is_open(lib, tx)
        key = keys.verify(tx, given) if given and not is_free else None
    return Caller(has_key=bool(given), is_free=is_free, address=address, key=key)


def caller_of_session(lib: Library, key_id: str, address: str | None) -> Caller:
    """The caller whose session stands for a key; `key_id` is empty without a session.

    Raises StorageError.
    """
    with lib.store.read() as tx:
        is_free = is_open(lib, tx)
        key = keys.valid(tx, key_id) if key_id and not is_free else None
    return Caller(has_key=bool(key_id), is_free=is_free, address=address, key=key)


def address_of(scope: Scope) -> str | None:
    """The client's IP address; None for a client without one (a Unix socket)."""
    client = scope.get("client")
    return None if client is None else str(client[0])[:MAX_ADDRESS_LENGTH]


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
