"""Calls: audit. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.audit import AuditList


def list_audit(
    *,
    since: str | None = None,
    until: str | None = None,
    key: str | None = None,
    action: str | None = None,
    clip: str | None = None,
    limit: int | None = None,
    cursor: str | None = None,
) -> Call[AuditList]:
    """Who changed, exported or forgot what, the newest first. This needs the role `admin`.

    A change has its row exactly if it took effect. Exports are downloads of files, recordings,
    exports and manifests; to look at a clip is none. What workers do later belongs to the call
    that queued the job, whose id is in `details`. Kinedex removes rows after
    `KINEDEX_AUDIT_RETENTION_DAYS` days.

    since: Not before this time (ISO 8601).
    until: Before this time.
    key: Id of an API key.
    clip: Id of a clip, which may be deleted.
    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.audit import AuditList

    return Call(
        "list_audit",
        "GET",
        "/v1/audit",
        record(AuditList),
        query=given(
            since=since, until=until, key=key, action=action, clip=clip, limit=limit, cursor=cursor
        ),
    )
