"""Whether the service lives and is ready; `/` leads to the documentation."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import RedirectResponse

from app.api.deps import Lib
from app.api.openapi import refusals
from app.api.problems import NotReadyYet, Unhealthy
from app.api.schemas.health import Alive, Ready

router = APIRouter(tags=["service"])


@router.get("/", include_in_schema=False)
def root(request: Request) -> RedirectResponse:
    """To the documentation, until there are pages."""
    return RedirectResponse(str(request.scope.get("root_path", "")).rstrip("/") + "/docs")


@router.get("/livez")
def livez() -> Alive:
    """The process answers. Needs no key."""
    return Alive()


@router.get("/readyz", responses={503: refusals(503)[503]})
def readyz(lib: Lib) -> Ready:
    """200 while every call can be answered. Needs no key.

    503 before the index is loaded, and while the database is damaged, deleted or replaced, the
    folder of files is missing or another one, or nothing can be written; `errors` names each.
    """
    troubles = lib.health.troubles()
    if troubles:
        raise Unhealthy(places=troubles)
    if not lib.index.is_loaded:
        raise NotReadyYet
    return Ready(library_version=lib.index.version, clips=len(lib.index))
