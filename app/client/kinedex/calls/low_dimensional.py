"""Calls: low dimensional. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import OCTETS, Call, path_of, record, text
from kinedex.positions import Positions, positions
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.choices import Basis
    from kinedex.types.low_dimensional import LowDimensional


def get_low_dimensional(
    clip_id: str,
    *,
    dimensions: int | None = None,
    basis: Basis | None = None,
    model_clips: str | None = None,
    poses: int | None = None,
    fps: float | None = None,
) -> Call[LowDimensional]:
    """The motion is projected onto the first K' principal axes of a few poses and then
    reconstructed (Perera 2009, equations 4 to 11). The answer also has the errors of this
    reconstruction. The poses are the keyposes of the clip, or of `model_clips`. With
    `basis=uniform` they are the same number of poses at equal intervals.

    `variance_kept` is the share of the variance of the model's own poses. It does not measure
    the motion: keyposes vary less than other poses, so the axes keep a larger share of their
    variance, but they may reconstruct the motion worse. `error` is the distance from the
    original motion.

    `implausible` counts poses that no body can take, for the motion and for the original: a knee
    or elbow folded by more than 160 degrees (`folded`), a knee bent forward by 10 or an elbow
    backward by 25 degrees (`bent_backward`), a head turned 70 degrees away from the line of the
    trunk (`turned_away`), a hand within 0.07 body lengths of the line from hips to neck
    (`in_trunk`).

    `Accept: application/octet-stream` returns only the positions, as `/motion` does.

    dimensions: K', from 1 to the number of poses of the model. Default: 3.
    basis: Poses of the model: keyposes, or the same number at equal intervals. Default: keypose.
    model_clips: Ids of the clips with the poses of the model, separated by commas, at most 50.
        Default: the clip itself.
    poses: Poses per clip with `basis=uniform`. Default: the number of its keyposes.
    fps: The motion is resampled to this rate. Default: 30, its own rate.
    """
    from kinedex.types.low_dimensional import LowDimensional

    return Call(
        "get_low_dimensional",
        "GET",
        path_of("/v1/clips/{clip_id}/low-dimensional", clip_id=clip_id),
        record(LowDimensional),
        query=given(
            dimensions=dimensions, basis=basis, model_clips=model_clips, poses=poses, fps=fps
        ),
    )


def get_low_dimensional_array(
    clip_id: str,
    *,
    dimensions: int | None = None,
    basis: Basis | None = None,
    model_clips: str | None = None,
    poses: int | None = None,
    fps: float | None = None,
) -> Call[Positions]:
    """The motion is projected onto the first K' principal axes of a few poses and then
    reconstructed (Perera 2009, equations 4 to 11). The answer also has the errors of this
    reconstruction. The poses are the keyposes of the clip, or of `model_clips`. With
    `basis=uniform` they are the same number of poses at equal intervals. The answer is an array.

    `variance_kept` is the share of the variance of the model's own poses. It does not measure
    the motion: keyposes vary less than other poses, so the axes keep a larger share of their
    variance, but they may reconstruct the motion worse. `error` is the distance from the
    original motion.

    `implausible` counts poses that no body can take, for the motion and for the original: a knee
    or elbow folded by more than 160 degrees (`folded`), a knee bent forward by 10 or an elbow
    backward by 25 degrees (`bent_backward`), a head turned 70 degrees away from the line of the
    trunk (`turned_away`), a hand within 0.07 body lengths of the line from hips to neck
    (`in_trunk`).

    `Accept: application/octet-stream` returns only the positions, as `/motion` does.

    dimensions: K', from 1 to the number of poses of the model. Default: 3.
    basis: Poses of the model: keyposes, or the same number at equal intervals. Default: keypose.
    model_clips: Ids of the clips with the poses of the model, separated by commas, at most 50.
        Default: the clip itself.
    poses: Poses per clip with `basis=uniform`. Default: the number of its keyposes.
    fps: The motion is resampled to this rate. Default: 30, its own rate.
    """
    return Call(
        "get_low_dimensional",
        "GET",
        path_of("/v1/clips/{clip_id}/low-dimensional", clip_id=clip_id),
        positions,
        query=given(
            dimensions=dimensions, basis=basis, model_clips=model_clips, poses=poses, fps=fps
        ),
        accept=OCTETS,
    )


def get_animation(
    clip_id: str,
    *,
    dimensions: int | None = None,
    basis: Basis | None = None,
    model_clips: str | None = None,
    poses: int | None = None,
    start: float | None = None,
    end: float | None = None,
) -> Call[str]:
    """The clip as a moving stick figure. With `dimensions`, it shows the low-dimensional motion.

    Left limbs are orange, right limbs are blue. Marks on the floor are half a meter apart.

    dimensions: K', from 1 to the number of poses of the model.
    basis: Poses of the model: keyposes, or the same number at equal intervals. Default: keypose.
    model_clips: Ids of the clips with the poses of the model, separated by commas, at most 50.
        Default: the clip itself.
    poses: Poses per clip with `basis=uniform`. Default: the number of its keyposes.
    start: Start of the part, seconds.
    end: End of the part, seconds.
    """
    return Call(
        "get_animation",
        "GET",
        path_of("/v1/clips/{clip_id}/animation.svg", clip_id=clip_id),
        text,
        query=given(
            dimensions=dimensions,
            basis=basis,
            model_clips=model_clips,
            poses=poses,
            start=start,
            end=end,
        ),
        accept="*/*",
    )
