"""The audit log: who changed, exported or forgot what, and when."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.api.deps import Lib, administers
from app.api.guard.admission import quick
from app.api.openapi import refusals
from app.api.schemas.audit import AuditList, AuditQuery
from app.services.library import audit

router = APIRouter(prefix="/v1/audit", tags=["service"], dependencies=[administers])


@router.get("", dependencies=[quick], responses=refusals(404))
def list_audit(lib: Lib, query: Annotated[AuditQuery, Query()]) -> AuditList:
    """Who changed, exported or forgot what, the newest first. This needs the role `admin`.

    A change has its row exactly if it took effect. Exports are downloads of files, recordings,
    exports and manifests; to look at a clip is none. What workers do later belongs to the call that
    queued the job, whose id is in `details`. Kinedex removes rows after
    `KINEDEX_AUDIT_RETENTION_DAYS` days.
    """
    page = audit.list_audit(lib, query.as_filter(), query.limit, query.cursor)
    return AuditList.model_validate(page)
