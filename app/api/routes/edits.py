"""Edits that make new clips."""

from __future__ import annotations

from fastapi import APIRouter, Depends, Response

from app.api.bodies import require_json
from app.api.deps import Lib, writes
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.schemas.clips import ClipCreated
from app.api.schemas.edits import ClipEdit
from app.errors import ClipNotReady, Conflict
from app.services.editing import edits

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"])

DESCRIPTION = """\
Make a new clip from a ready clip by one or more steps, which are done one after the other:

- **cut** keeps the part from `start` to `end`.
- **mirror** exchanges left and right, about the vertical plane through the hips of the first frame
  along the way the body faces: what the left hand did, the right hand does. Labels, words, captions
  and metadata exchange `left` and `right` too; the person, the license and the source stay.
- **resample** changes the frame rate; rotations are interpolated.
- **in_place** removes the horizontal path of the hips. Heights and turns stay.
- **loop** keeps the part whose end is followed best by its beginning: the pair of frames whose
  poses and velocities differ least, relative to how far the pose moves between them. The last 0.2 s
  are blended, so that repeats follow each other without a jump, each from where the last one ended.

The new clip is a BVH file, which is analyzed like an upload. It has the labels of the original, its
recording, and the beats and the annotated keyposes of the part; `origin` says where it comes
from. The original may be deleted: the copy remains, and says so. No model learns from a copy while
its original is there. The same edit of the same clip is stored once (200).
"""


@router.post(
    "/edits",
    status_code=202,
    description=DESCRIPTION,
    dependencies=[writes, Depends(require_json), heavy],
    responses={
        200: {"model": ClipCreated, "description": "The same edit was stored before."},
        **refusals(400, 404, 413, 415, 503, 507, ClipNotReady, Conflict),
    },
)
def edit_clip(lib: Lib, clip_id: ClipId, sent: ClipEdit, response: Response) -> ClipCreated:
    """Make a new clip: cut, mirrored, at another rate, in place, or as a loop."""
    steps = [step.step() for step in sent.steps]
    created = edits.edit_clip(lib, clip_id, steps, sent.name)
    if created.job is None:
        response.status_code = 200
    return ClipCreated.model_validate(created)
