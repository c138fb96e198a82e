"""Calls: export. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.call import Call, content, path_of
from kinedex.sent import given
from kinedex.types.choices import Basis, ExportFormat, ExportSkeleton


def get_export(
    clip_id: str,
    format: ExportFormat,
    *,
    dimensions: int | None = None,
    basis: Basis | None = None,
    model_clips: str | None = None,
    poses: int | None = None,
    fps: float | None = None,
    skeleton: ExportSkeleton | None = None,
) -> Call[bytes]:
    """The clip as an attachment, Y up. Positions come back within 0.1 mm.

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

    dimensions: K', from 1 to the number of poses of the model.
    basis: Poses of the model: keyposes, or the same number at equal intervals. Default: keypose.
    model_clips: Ids of the clips with the poses of the model, separated by commas, at most 50.
        Default: the clip itself.
    poses: Poses per clip with `basis=uniform`. Default: the number of its keyposes.
    format: BVH (centimeters), or GLB (glTF 2.0), NPZ (NumPy), CSV (all in meters).
    fps: The motion is resampled to this rate. Default: the clip's own rate.
    skeleton: own: the joints of the clip. canonical: one skeleton of 18 joints for all clips.
        Default: own.
    """
    return Call(
        "get_export",
        "GET",
        path_of("/v1/clips/{clip_id}/export", clip_id=clip_id),
        content,
        query=given(
            dimensions=dimensions,
            basis=basis,
            model_clips=model_clips,
            poses=poses,
            format=format,
            fps=fps,
            skeleton=skeleton,
        ),
        accept="*/*",
    )
