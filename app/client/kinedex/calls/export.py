"""Calls: export. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, read_bytes
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.choices import (
        Basis,
        ExportContent,
        ExportFormat,
        ExportJoints,
        ExportSkeleton,
        ExportUnit,
    )


def get_export(
    clip_id: str,
    format: ExportFormat,
    *,
    dimensions: int | None = None,
    basis: Basis | None = None,
    model_clips: str | None = None,
    poses: int | None = None,
    content: ExportContent | None = None,
    unit: ExportUnit | None = None,
    joints: ExportJoints | None = None,
    fps: float | None = None,
    skeleton: ExportSkeleton | None = None,
) -> Call[bytes]:
    """The clip as an attachment. Positions come back within 0.1 mm. Y is up but for C3D.

    - **bvh**: centimeters, or `unit` (Blender expects `m`). Rotations are the file's own where
    it had some, else solved from the positions; joints whose bones change length have six
    channels.
    - **glb**: meters; a node a joint, one animation, and a skinned body of sticks to be seen.
    - **npz**: meters; arrays that `POST /v1/clips` reads too: `positions` (frames, joints, 3),
    `joint_names` (joints,), `parents` (joints,) with -1 for a root, `frame_rate` Hz, `unit`
    ("m", "cm", ... or meters per unit) and `up_axis` ("x", "y" or "z").
    - **csv**: a table, see below.
    - **c3d**: millimeters or `unit`, Z up (X stays, the old -Z is the new Y); a point a joint.
    - **trc**: millimeters or `unit`, Y up, as OpenSim reads it; a marker a joint. Labels of C3D
    and TRC have no spaces and are unique.

    `skeleton=canonical` plays the movement on one body of 18 joints, 1.7 m tall, whatever the
    clip's: bones point where the clip's do, and feet that stand stay on the floor.

    `joints=roles` leaves only the joints of which the role is known, and calls them by role, so
    that columns and labels are the same for all clips; so a C3D file can always be imported
    again.

    `dimensions` draws the motion from few dimensions (see `/low-dimensional`), on the 13 joint
    roles and by default at 30 frames a second. Rotations are solved; bones change their length a
    little, so joints have six channels, unless `skeleton=canonical`.

    ### Tables: `format=csv`

    Commas, a header with units, lines that end with CR LF (RFC 4180), no comments. A value that
    is not known is empty.

    - `content=positions`: a row a frame: `time_s`, then `<joint>_x_m`, `_y_m`, `_z_m`.
    - `content=angles`: a row a frame: `time_s`, the angles below, `neutral_pose`.
    - `content=segments`: a row a segment, from keypose to keypose: `segment`, `start_s`,
    `end_s`, `duration_s`, `cycle` and `run` (see `/segments`). 409 `not_enough_keyposes` if
    there are none.
    - `content=gait`: a row a parameter below: mean, sample standard deviation (`sd`) and number
    of strides of the left side, of the right side and of both, and `symmetry_index_pct` = 100
    (right - left) / mean of both (Robinson et al. 1987; 0 is symmetry).
    - `content=strides`: a row a stride: `side`, `gait` (walk or run), its events in seconds of
    the clip, and the parameters below.
    - `content=cycles`: the angles over the gait cycle: for each side 101 rows, `cycle_pct` from
    0 (foot strike) to 100 (next strike of that foot), with mean and `sd` over the strides; names
    of angles without the side. Rotations of pelvis and thorax are relative to the direction of
    the stride.

    A clip without walking has no gait, strides or cycles: 422 `no_gait` says what is missing.

    ### Joint angles

    Degrees. Segments have the frames of the ISB (X forward, Y up, Z to the right). Hip, knee,
    ankle and trunk: joint coordinate system of Grood and Suntay (1983; Wu et al. 2002), Cardan
    sequence Z-X-Y. Pelvis and thorax in the laboratory: Y-X-Z (Baker 2001). Shoulder: Y-X-Y (Wu
    et al. 2005) for plane of elevation and elevation, Z-X-Y for flexion and adduction. Angles
    are not filtered.

    `neutral_pose` says which pose has angles of zero:

    - `rest_pose`: that of the file (all rotations 0), a person who stands, as a T-pose. Long
    axes of limbs are the lines between joint centers, so a bent limb is bent; a sole is at a
    right angle to the shank from side to side.
    - `upright_pose`: the file's rest pose is no standing person. The pelvis has no tilt in the
    most upright frame of the clip, and no obliquity where the hip joints are level; the thorax
    leans as the line from hips to neck; a foot is neutral while it is flat on the floor; knees
    and elbows bend about the mean axis that the motion shows.
    - `positions`: the file has no rotations. Only angles that positions determine are there:
    knee and elbow flexion (0 or more), thorax, and where the arm points. Markers give more: ASIS
    with PSIS or sacrum the pelvis, the trunk, hip flexion and adduction; both sides of the knee
    hip rotation and the sign of knee flexion; those of the ankle too knee adduction and
    rotation, and with heel and toe ankle dorsiflexion. Other columns are empty.

    - `pelvis_anterior_tilt_deg`: pelvis in the laboratory; positive: the front of the pelvis
    goes down
    - `pelvis_obliquity_deg`: pelvis in the laboratory; positive: the left side is higher
    - `pelvis_rotation_deg`: pelvis in the laboratory, about the vertical, unwrapped; 0 faces +Z
    of the positions; positive: turned to the left (counterclockwise from above)
    - `thorax_anterior_tilt_deg`: thorax in the laboratory; positive: leans forward
    - `thorax_obliquity_deg`: thorax in the laboratory; positive: the left side is higher
    - `thorax_rotation_deg`: thorax in the laboratory, as pelvis_rotation_deg
    - `trunk_flexion_deg`: thorax relative to the pelvis; positive: bends forward
    - `trunk_left_lateral_flexion_deg`: thorax relative to the pelvis; positive: bends to the
    left
    - `trunk_left_rotation_deg`: thorax relative to the pelvis; positive: turns to the left
    - `left_/right_hip_flexion_deg`: thigh relative to the pelvis; positive: the knee goes
    forward
    - `left_/right_hip_adduction_deg`: positive: the knee goes toward the other leg
    - `left_/right_hip_internal_rotation_deg`: positive: the front of the thigh turns inward
    - `left_/right_knee_flexion_deg`: shank relative to the thigh; 0: straight; positive: the
    knee bends
    - `left_/right_knee_adduction_deg`: positive: varus, the foot goes inward
    - `left_/right_knee_internal_rotation_deg`: positive: the front of the shank turns inward
    - `left_/right_ankle_dorsiflexion_deg`: foot relative to the shank; positive: the toes go up
    - `left_/right_ankle_inversion_deg`: positive: the sole turns inward
    - `left_/right_ankle_internal_rotation_deg`: positive: the toes turn inward
    - `left_/right_shoulder_flexion_deg`: upper arm relative to the thorax; 0: it hangs;
    positive: it goes forward
    - `left_/right_shoulder_adduction_deg`: negative: the arm goes away from the body (abduction)
    - `left_/right_shoulder_plane_of_elevation_deg`: the direction in which the arm is raised; 0:
    to the side; 90: forward; noise while the arm hangs
    - `left_/right_shoulder_elevation_deg`: 0: the arm hangs; 90: horizontal; 180: overhead
    - `left_/right_shoulder_internal_rotation_deg`: about the long axis of the upper arm, the
    third angle of the Y-X-Y sequence, plus the first one; positive: the front of the upper arm
    turns inward
    - `left_/right_elbow_flexion_deg`: forearm relative to the upper arm; 0: straight; positive:
    bent

    ### Gait parameters

    Foot strikes and foot offs by Zeni, Richards and Higginson (2008): a foot strikes where its
    ankle is farthest ahead of the hips along the local direction of progress, and leaves where
    its toes are farthest behind. Positions are filtered at 6 Hz first (Butterworth, no delay).
    Where a stride is a run, times that need the foot off are empty: the method does not find it
    there.

    - `cadence_steps_per_min`: two steps per stride, divided by the stride time
    - `speed_m_per_s`: stride length divided by stride time
    - `stride_time_s`: from a foot strike to the next strike of the same foot
    - `stride_length_m`: distance on the floor between the places of the ankle at these two
    strikes
    - `step_time_s`: from the strike of the other foot to the next strike of this foot (a left
    step ends with the strike of the left foot)
    - `step_length_m`: distance between the places of the two ankles at these two strikes, along
    the line of the stride
    - `step_width_m`: distance of the other ankle's place from the line of the stride; negative
    if feet cross
    - `stance_time_s`: from the foot strike to the foot off
    - `swing_time_s`: from the foot off to the next foot strike
    - `stance_pct`: stance time in percent of the stride time
    - `swing_pct`: swing time in percent of the stride time
    - `double_support_pct`: time with both feet on the floor, at the beginning and the end of the
    stance together, in percent of the stride time
    - `single_support_pct`: stance without double support, in percent of the stride time

    dimensions: K', from 1 to the number of poses of the model.
    basis: Poses of the model: keyposes, or the same number at equal intervals. Default: keypose.
    model_clips: Ids of the clips with the poses of the model, separated by commas, at most 50.
        Default: the clip itself.
    poses: Poses per clip with `basis=uniform`. Default: the number of its keyposes.
    format: BVH, GLB (glTF 2.0), NPZ (NumPy), CSV, C3D or TRC (OpenSim).
    content: The table of a CSV file, with format=csv only; default: positions.
    unit: Of lengths; default: cm for BVH, mm for C3D and TRC, m for the others. GLB, NPZ and
        tables other than positions are in m only.
    joints: All joints by their own names, or those with a role, by role: with NPZ, C3D, TRC and
        CSV positions. Default: all.
    fps: Resampled by time; default: the clip's own rate. Not with tables of segments and gait.
    skeleton: own: the joints of the clip. canonical: one skeleton of 18 joints for all clips.
        Default: own.
    """
    return Call(
        "get_export",
        "GET",
        path_of("/v1/clips/{clip_id}/export", clip_id=clip_id),
        read_bytes,
        query=given(
            dimensions=dimensions,
            basis=basis,
            model_clips=model_clips,
            poses=poses,
            format=format,
            content=content,
            unit=unit,
            joints=joints,
            fps=fps,
            skeleton=skeleton,
        ),
        accept="*/*",
    )
