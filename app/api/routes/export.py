"""A clip as a file for other programs."""

from __future__ import annotations

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from app.analysis.angles import definitions as angles
from app.analysis.gait import parameters as gait
from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.guard.audited import exported
from app.api.openapi import BINARY, ClipId, refusals
from app.api.pieces import Pieces
from app.api.schemas.export import ExportQuery
from app.api.validators import UNCHANGED, of_one_clip
from app.errors import ClipNotReady, NotEnoughKeyposes
from app.services.views.export import export
from app.services.views.export_format import ExportFormat

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads_source])

MEDIA_TYPES = {
    ExportFormat.BVH: "application/octet-stream",
    ExportFormat.GLB: "model/gltf-binary",
    ExportFormat.NPZ: "application/zip",
    ExportFormat.CSV: "text/csv",
    ExportFormat.C3D: "application/octet-stream",
    ExportFormat.TRC: "text/tab-separated-values",
}
DESCRIPTION = f"""\
The clip as an attachment. Positions come back within 0.1 mm. Y is up but for C3D.

- **bvh**: centimeters, or `unit` (Blender expects `m`). Rotations are the file's own where it had
  some, else solved from the positions; joints whose bones change length have six channels.
- **glb**: meters; a node a joint, one animation, and a skinned body of sticks to be seen.
- **npz**: meters; arrays that `POST /v1/clips` reads too: `positions` (frames, joints, 3),
  `joint_names` (joints,), `parents` (joints,) with -1 for a root, `frame_rate` Hz, `unit`
  ("m", "cm", ... or meters per unit) and `up_axis` ("x", "y" or "z").
- **csv**: a table, see below.
- **c3d**: millimeters or `unit`, Z up (X stays, the old -Z is the new Y); a point a joint.
- **trc**: millimeters or `unit`, Y up, as OpenSim reads it; a marker a joint. Labels of C3D and TRC
  have no spaces and are unique.

`skeleton=canonical` plays the movement on one body of 18 joints, 1.7 m tall, whatever the
clip's: bones point where the clip's do, and feet that stand stay on the floor.

`joints=roles` leaves only the joints of which the role is known, and calls them by role, so that
columns and labels are the same for all clips; so a C3D file can always be imported again.

`dimensions` draws the motion from few dimensions (see `/low-dimensional`), on the 13 joint
roles and by default at 30 frames a second. Rotations are solved; bones change their length a
little, so joints have six channels, unless `skeleton=canonical`.

### Tables: `format=csv`

Commas, a header with units, lines that end with CR LF (RFC 4180), no comments. A value that is not
known is empty.

- `content=positions`: a row a frame: `time_s`, then `<joint>_x_m`, `_y_m`, `_z_m`.
- `content=angles`: a row a frame: `time_s`, the angles below, `neutral_pose`.
- `content=segments`: a row a segment, from keypose to keypose: `segment`, `start_s`, `end_s`,
  `duration_s`, `cycle` and `run` (see `/segments`). 409 `not_enough_keyposes` if there are none.
- `content=gait`: a row a parameter below: mean, sample standard deviation (`sd`) and number of
  strides of the left side, of the right side and of both, and `symmetry_index_pct`
  = 100 (right - left) / mean of both (Robinson et al. 1987; 0 is symmetry).
- `content=strides`: a row a stride: `side`, `gait` (walk or run), its events in seconds of the
  clip, and the parameters below.
- `content=cycles`: the angles over the gait cycle: for each side 101 rows, `cycle_pct` from 0 (foot
  strike) to 100 (next strike of that foot), with mean and `sd` over the strides; names of angles
  without the side. Rotations of pelvis and thorax are relative to the direction of the stride.

A clip without walking has no gait, strides or cycles: 422 `no_gait` says what is missing.

### Joint angles

Degrees. Segments have the frames of the ISB (X forward, Y up, Z to the right). Hip, knee, ankle and
trunk: joint coordinate system of Grood and Suntay (1983; Wu et al. 2002), Cardan sequence Z-X-Y.
Pelvis and thorax in the laboratory: Y-X-Z (Baker 2001). Shoulder: Y-X-Y (Wu et al. 2005) for plane
of elevation and elevation, Z-X-Y for flexion and adduction. Angles are not filtered.

`neutral_pose` says which pose has angles of zero:

- `rest_pose`: that of the file (all rotations 0), a person who stands, as a T-pose. Long axes
  of limbs are the lines between joint centers, so a bent limb is bent; a sole is at a right angle
  to the shank from side to side.
- `upright_pose`: the file's rest pose is no standing person. The pelvis has no tilt in the most
  upright frame of the clip, and no obliquity where the hip joints are level; the thorax leans as
  the line from hips to neck; a foot is neutral while it is flat on the floor; knees and elbows
  bend about the mean axis that the motion shows.
- `positions`: the file has no rotations. Only angles that positions determine are there: knee and
  elbow flexion (0 or more), thorax, and where the arm points. Markers give more: ASIS with PSIS or
  sacrum the pelvis, the trunk, hip flexion and adduction; both sides of the knee hip rotation and
  the sign of knee flexion; those of the ankle too knee adduction and rotation, and with heel and
  toe ankle dorsiflexion. Other columns are empty.

{angles.explained()}

### Gait parameters

Foot strikes and foot offs by Zeni, Richards and Higginson (2008): a foot strikes where its ankle is
farthest ahead of the hips along the local direction of progress, and leaves where its toes are
farthest behind. Positions are filtered at 6 Hz first (Butterworth, no delay). Where a stride is a
run, times that need the foot off are empty: the method does not find it there.

{gait.explained()}
"""


@router.get(
    "/export",
    response_class=StreamingResponse,
    dependencies=[exported, of_one_clip, heavy],
    description=DESCRIPTION,
    responses={
        200: {
            "description": "The file, as an attachment.",
            "content": dict.fromkeys(MEDIA_TYPES.values(), BINARY),
        },
        304: UNCHANGED,
        **refusals(404, ClipNotReady, NotEnoughKeyposes),
    },
)
def get_export(lib: Lib, clip_id: ClipId, query: Annotated[ExportQuery, Query()]) -> Response:
    """The clip as a BVH, GLB, NPZ, CSV, C3D or TRC file."""
    file = export(
        lib,
        clip_id,
        query.format,
        content=query.content,
        unit=query.unit,
        joints=query.joints,
        skeleton=query.skeleton,
        fps=query.fps,
        reduction=query.reduction_if_any(),
    )
    return Pieces(
        file.blocks,
        media_type=MEDIA_TYPES[query.format],
        headers={"Content-Disposition": attachment(file.file_name)},
    )


def attachment(name: str) -> str:
    """A Content-Disposition that any client understands (RFC 6266), whatever the name holds."""
    plain = "".join(c if c.isascii() and c.isprintable() and c not in '"\\' else "_" for c in name)
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"
