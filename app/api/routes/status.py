"""The status of the library."""

from __future__ import annotations

from fastapi import APIRouter

from app import __version__
from app.api.deps import Lib, reads
from app.api.guard.admission import quick
from app.api.openapi import refusals
from app.api.schemas.status import DiskStatus, IsolationStatus, QueueStatus, Status
from app.services.children import sandbox
from app.services.library.status import status_of

router = APIRouter(prefix="/v1/status", tags=["service"])


@router.get("", dependencies=[reads, quick], responses=refusals())
def get_status(lib: Lib) -> Status:
    """What the library holds, what waits, and how full its disk is."""
    found = status_of(lib)
    return Status(
        version=__version__,
        library_version=found.library_version,
        clips=dict(found.clips),
        jobs=[QueueStatus.model_validate(one) for one in found.jobs],
        disk=DiskStatus.model_validate(found.disk),
        isolation=IsolationStatus.model_validate(sandbox.status()),
    )
