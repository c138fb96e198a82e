"""Sign in with a browser: the key is exchanged for a cookie that no script can read."""

from __future__ import annotations

from fastapi import APIRouter, Depends, Request, Response

from app.api.bodies import require_json
from app.api.guard.access_check import COOKIE
from app.api.guard.admission import at_once, quick
from app.api.guard.callers import Caller, address_of
from app.api.guard.own_address import refuse_other_pages
from app.api.guard.rates import RateLimits
from app.api.openapi import refusals
from app.api.schemas.session import Session, SignIn
from app.store.sessions import Sessions

router = APIRouter(prefix="/v1/session", tags=["service"])


@router.get("", dependencies=[at_once], responses=refusals())
async def get_session(request: Request) -> Session:
    """Whether keys are needed here, and what the caller's key allows. Needs no key."""
    return _session(request.state.caller)


@router.post("", dependencies=[Depends(require_json), quick], responses=refusals(400, 413, 415))
def sign_in(request: Request, sent: SignIn, response: Response) -> Session:
    """Sign in: the answer sets a cookie that stands for the key.

    It does so until it is signed out, the key expires, or 12 hours pass without a call. Only pages
    of this service can use it. After too many wrong keys from one address, the answer is 429 for a
    while. Where no keys are needed, send an empty key: the answer is that of `GET`.
    """
    refuse_other_pages(request.scope)
    limits: RateLimits = request.app.state.limits
    caller = limits.identify(sent.key, address_of(request.scope))
    caller.require_key()
    if caller.key_id is None:  # no keys are needed
        return _session(caller)
    sessions: Sessions = request.app.state.sessions
    response.set_cookie(
        COOKIE,
        sessions.begin(caller.key_id),
        path=_home(request),
        secure=request.url.scheme == "https",
        httponly=True,
        samesite="strict",
    )
    return _session(caller)


@router.delete("", status_code=204, dependencies=[quick], responses=refusals())
def sign_out(request: Request, response: Response) -> None:
    """Sign out: the cookie is removed, and stands for nothing any more."""
    sessions: Sessions = request.app.state.sessions
    token = request.cookies.get(COOKIE)
    if token:
        sessions.end(token)
    response.delete_cookie(COOKIE, path=_home(request), httponly=True, samesite="strict")


def _session(caller: Caller) -> Session:
    expires_at = None if caller.key is None else caller.key.expires_at
    return Session(
        keys_needed=not caller.is_free,
        role=caller.role,
        source=caller.source,
        expires_at=expires_at,
    )


def _home(request: Request) -> str:
    return str(request.scope.get("root_path", "")).rstrip("/") or "/"
