"""Calls: session. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, nothing, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.session import Session


def get_session() -> Call[Session]:
    """Whether keys are needed here, and what the caller's key allows. Needs no key."""
    from kinedex.types.session import Session

    return Call("get_session", "GET", "/v1/session", record(Session))


def sign_in(key: str) -> Call[Session]:
    """Sign in: the answer sets a cookie that stands for the key.

    It does so until it is signed out, the key expires, or 12 hours pass without a call. Only
    pages of this service can use it. After too many wrong keys from one address, the answer is
    429 for a while. Where no keys are needed, send an empty key: the answer is that of `GET`.

    key: An API key.
    """
    from kinedex.types.session import Session

    return Call("sign_in", "POST", "/v1/session", record(Session), json=given(key=key))


def sign_out() -> Call[None]:
    """Sign out: the cookie is removed, and stands for nothing any more."""
    return Call("sign_out", "DELETE", "/v1/session", nothing)
