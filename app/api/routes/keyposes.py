"""The keyposes of a clip: those that Kinedex finds, and those that a person names."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from app.api.bodies import require_json
from app.api.deps import Lib, reads_source, writes
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.schemas.keyposes import KeyposeQuery, Keyposes, KeyposesNamed, NamedKeyposes
from app.errors import ClipNotReady
from app.services.views import keyposes

router = APIRouter(prefix="/v1/clips/{clip_id}/keyposes", tags=["clips"])

_FOUND = """\
Beats, keyposes and energy curves (Perera 2009, section 3), and the keyposes that a person named.

Near each known beat (given, from a tempo or from a recording), the minimum of the energy is a
keypose if it is below `t1`, or more than `t2` below the maxima on its two sides. The global energy
is tried first, then the local energy. Without known beats, every rest of the body is tested in this
way. `t1` and `t2` are shares of the median local maximum of each curve, so that they fit calm and
wild motions. Without them, the thresholds are those of the clip's segments and low-dimensional
motions: learned from the annotated clips of this library, or else the defaults. When a fit learns
other thresholds, all clips are analyzed again; each has its old keyposes until then, everywhere.
A motion without rests has its keyposes where it is slowest relative to the waist, as in the steps
of a walk.
"""
_NAMED = """\
Name the times of the clip's keyposes. Its segments, its low-dimensional motions and the thresholds
of the next fit then use these keyposes. `GET` shows them beside the keyposes that Kinedex finds.
"""


@router.get(
    "",
    dependencies=[reads_source, heavy],
    responses=refusals(404, ClipNotReady),
    description=_FOUND,
)
def get_keyposes(lib: Lib, clip_id: ClipId, query: Annotated[KeyposeQuery, Query()]) -> Keyposes:
    """A clip's keyposes."""
    return Keyposes.of(
        keyposes.view(lib, clip_id, query.method, query.t1, query.t2, weights=query.weights)
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
    """Delete the named keyposes. Then the keyposes that Kinedex finds are used again."""
    keyposes.annotate_keyposes(lib, clip_id, ())
