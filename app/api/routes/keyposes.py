"""A clip's keyposes: found, and named by people."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.schemas.keyposes import KeyposeQuery, Keyposes, KeyposesNamed, NamedKeyposes
from app.services.views import keyposes

router = APIRouter(prefix="/v1/clips/{clip_id}/keyposes", tags=["clips"])

_FOUND = """\
Beats, keyposes and energy curves (Perera 2009, section 3), beside what a person named.

Around each known beat the energy's minimum is a keypose if it is below `t1`, or more than
`t2` below the maxima beside it; in the global energy first, else in the local one. Without
known beats every rest of the body is looked at in that way. `t1` and `t2` are shares of the
median local maximum of each curve, so that they fit calm and wild motions alike; where they
are not given, those learned from the annotated clips of this library count, else usual ones.
A motion that goes on without rest has its keyposes where it is slowest as seen from the waist:
a walker's steps.
"""
_NAMED = """\
Say where the clip's keyposes are. They are then what its segments, its low-dimensional motions
and the next fit's thresholds are made of; `GET` shows them beside the found ones.
"""


@router.get("", dependencies=[reads, heavy], responses=refusals(404, 409), description=_FOUND)
def get_keyposes(lib: Lib, clip_id: ClipId, wanted: Annotated[KeyposeQuery, Query()]) -> Keyposes:
    """A clip's keyposes."""
    return Keyposes.of(
        keyposes.view(lib, clip_id, wanted.method, wanted.t1, wanted.t2, weights=wanted.weights)
    )


@router.put(
    "",
    dependencies=[writes, Depends(require_json), heavy],
    responses=refusals(400, 404, 413, 415),
    description=_NAMED,
)
def name_keyposes(lib: Lib, clip_id: ClipId, named: NamedKeyposes) -> KeyposesNamed:
    """Name a clip's keyposes."""
    return KeyposesNamed(times=list(keyposes.annotate_keyposes(lib, clip_id, named.times)))


@router.delete("", status_code=204, dependencies=[writes, heavy], responses=refusals(404))
def forget_named_keyposes(lib: Lib, clip_id: ClipId) -> None:
    """Take away what was named: the found keyposes count again."""
    keyposes.annotate_keyposes(lib, clip_id, ())
