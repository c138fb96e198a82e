"""Health of the service: alive, ready."""

from __future__ import annotations

from fastapi import APIRouter, Request

from app.api.deps import Lib
from app.api.failures.problems import NotReadyYet, Unhealthy
from app.api.guard.admission import OwnThreads, at_once
from app.api.loading import Loading
from app.api.openapi import refusals
from app.api.schemas.health import Alive, Ready
from app.api.schemas.problem import ProblemPlace
from app.services.library.library import Library
from app.store.upkeep.file_watch import FileWatch
from app.store.upkeep.health import FILES

router = APIRouter(tags=["service"])

_threads = OwnThreads(2)


@router.get("/livez", dependencies=[at_once])
async def livez() -> Alive:
    """Answer, even if all threads are busy. Needs no key."""
    return Alive()


@router.get("/readyz", dependencies=[at_once], responses={503: refusals(503)[503]})
async def readyz(request: Request, lib: Lib) -> Ready:
    """Answer 200 while every call can be answered. Needs no key.

    The answer is 503 before the index is loaded, and while the database is damaged, deleted or
    replaced, the folder of files is missing or replaced, or nothing can be written. `errors` names
    every problem. Stored files that are missing or damaged are counted in `warnings`, because the
    answer stays 200: only downloads and new analyses need these files.
    """
    loading: Loading | None = request.app.state.loading
    return await _threads.run(lambda: _look(lib, loading))


def _look(lib: Library, loading: Loading | None) -> Ready:
    troubles = lib.health.troubles()
    if troubles:
        raise Unhealthy(places=troubles)
    if not lib.index.is_loaded:
        raise NotReadyYet
    return Ready(
        library_version=lib.index.version,
        clips=len(lib.index),
        is_warm=loading is not None and loading.is_warm,
        warnings=_warnings(lib.health.files),
    )


def _warnings(files: FileWatch) -> list[ProblemPlace]:
    """The numbers of bad files. It names none, because anybody can read this without a key."""
    counts = {"missing": len(files.bad.missing), "damaged": len(files.bad.damaged)}
    return [
        ProblemPlace(location=FILES, message=f"stored files that are {kind}: {count}")
        for kind, count in counts.items()
        if count
    ]
