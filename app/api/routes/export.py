"""A clip as a file for other programs."""

from __future__ import annotations

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from app.api.deps import Lib, reads
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.pieces import Pieces
from app.api.schemas.export import ExportQuery
from app.api.validators import UNCHANGED, of_one_clip
from app.services.views.export import export
from app.services.views.export_format import ExportFormat

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads])

MEDIA_TYPES = {
    ExportFormat.BVH: "application/octet-stream",
    ExportFormat.GLB: "model/gltf-binary",
    ExportFormat.NPZ: "application/zip",
    ExportFormat.CSV: "text/csv",
}
DESCRIPTION = """\
The clip as an attachment, Y up. Positions come back within 0.1 mm.

- **bvh**: centimetres. Rotations are the file's own where it had some, else solved from the
  positions; joints whose bones change length have six channels.
- **glb**: metres; a node a joint, one animation, and a skinned body of sticks to be seen.
- **npz**: metres; arrays that `POST /v1/clips` reads too: `positions` (frames, joints, 3),
  `joint_names` (joints,), `parents` (joints,) with -1 for a root, `frame_rate` Hz, `unit`
  ("m", "cm", ... or metres per unit) and `up_axis` ("x", "y" or "z").
- **csv**: a row a frame: `time` in seconds, then x, y and z of each joint in metres.

`skeleton=canonical` plays the movement on one body of 18 joints, 1.7 m tall, whatever the
clip's: bones point where the clip's do, and feet that stand stay on the floor.

`dimensions` draws the motion from few dimensions (see `/low-dimensional`), on the 13 joint
roles and by default at 30 frames a second. Rotations are solved; bones change their length a
little, so joints have six channels, unless `skeleton=canonical`.
"""


@router.get(
    "/export",
    response_class=StreamingResponse,
    dependencies=[of_one_clip, heavy],
    description=DESCRIPTION,
    responses={
        200: {
            "description": "The file, as an attachment.",
            "content": {
                kind: {"schema": {"type": "string", "format": "binary"}}
                for kind in MEDIA_TYPES.values()
            },
        },
        304: UNCHANGED,
        **refusals(404, 409),
    },
)
def get_export(lib: Lib, clip_id: ClipId, wanted: Annotated[ExportQuery, Query()]) -> Response:
    """The clip as a BVH, GLB, NPZ or CSV file."""
    file = export(
        lib,
        clip_id,
        wanted.format,
        fps=wanted.fps,
        skeleton=wanted.skeleton,
        reduction=wanted.reduction_if_any(),
    )
    return Pieces(
        file.blocks,
        media_type=MEDIA_TYPES[wanted.format],
        headers={"Content-Disposition": attachment(file.file_name)},
    )


def attachment(name: str) -> str:
    """A Content-Disposition that any client understands (RFC 6266), whatever the name holds."""
    plain = "".join(c if c.isascii() and c.isprintable() and c not in '"\\' else "_" for c in name)
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"
