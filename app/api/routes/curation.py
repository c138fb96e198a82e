"""Near-duplicates and outliers: lists for people, and what they decide."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.openapi import ClipId, GroupId, refusals
from app.api.schemas.clips import Clip
from app.api.schemas.curation import (
    AcceptedOutlier,
    DismissedOutlier,
    DuplicateGroups,
    DuplicateQuery,
    DuplicateThreshold,
    OutlierList,
    OutlierQuery,
)
from app.errors import Conflict
from app.search.index.filters import parse_filter
from app.services.curation import duplicates, outliers

router = APIRouter(prefix="/v1", tags=["curation"])


@router.get("/duplicates", dependencies=[reads, quick], responses=refusals(404))
def list_duplicates(lib: Lib, query: Annotated[DuplicateQuery, Query()]) -> DuplicateGroups:
    """Groups of near-duplicates, each with a clip to keep and the evidence of each pair.

    Kinds: `exact` the same poses; `copy` with noise or another cleaning; `rate` and `format` the
    same take at another frame rate, in another format or with another skeleton; `cut` a part;
    `mirror` left and right exchanged; `similar` another take within `threshold`. A worker compares
    new clips when it is idle: `pending` clips still wait.
    """
    found = duplicates.list_groups(
        lib, threshold=query.threshold, kind=query.kind, limit=query.limit, cursor=query.cursor
    )
    page = found.page
    return DuplicateGroups.model_validate(
        {
            "items": page.items,
            "next": page.next,
            "total": page.total,
            "total_is_exact": page.total_is_exact,
            "pending": found.pending,
        }
    )


@router.post(
    "/duplicates/{group_id}/dismiss",
    status_code=204,
    dependencies=[writes, changes],
    responses=refusals(404),
)
def dismiss_duplicates(
    lib: Lib, group_id: GroupId, query: Annotated[DuplicateThreshold, Query()]
) -> None:
    """These clips are no duplicates: no list shows these pairs again.

    `threshold` must be that of the list that showed the group.
    """
    duplicates.dismiss(lib, group_id, threshold=query.threshold)


@router.get("/outliers", dependencies=[reads, heavy], responses=refusals())
def list_outliers(lib: Lib, query: Annotated[OutlierQuery, Query()]) -> OutlierList:
    """Clips that differ from the others with their task: wrong labels, or faults.

    `far`: the clip is far from the task's other clips; `suggested` is the task of the clips that
    are nearer. `swapped`: it moves the other side than the task's clips do.
    """
    found = outliers.list_outliers(lib, parse_filter(query.given()), query.limit)
    return OutlierList.model_validate({"items": found})


@router.post(
    "/outliers/{clip_id}/accept",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415, Conflict),
)
def accept_outlier(lib: Lib, clip_id: ClipId, accepted: AcceptedOutlier) -> Clip:
    """The label is wrong: the clip gets the suggested task, or the one that is sent.

    For the reason `swapped`, the sides in the clip's words are exchanged too.
    """
    changed = outliers.accept(lib, clip_id, accepted.reason, accepted.task)
    return Clip.model_validate(changed)


@router.post(
    "/outliers/{clip_id}/dismiss",
    status_code=204,
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def dismiss_outlier(lib: Lib, clip_id: ClipId, dismissed: DismissedOutlier) -> None:
    """The label is right: no list shows the clip for this reason while it has this task."""
    outliers.dismiss(lib, clip_id, dismissed.reason)
