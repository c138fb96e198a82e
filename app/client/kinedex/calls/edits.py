"""Calls: edits. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.bodies import Step
    from kinedex.types.clips import ClipCreated


def edit_clip(clip_id: str, steps: Sequence[Step], *, name: str | None = None) -> Call[ClipCreated]:
    """Make a new clip from a ready clip by one or more steps, which are done one after the other:

    - **cut** keeps the part from `start` to `end`.
    - **mirror** exchanges left and right, about the vertical plane through the hips of the first
    frame along the way the body faces: what the left hand did, the right hand does. Labels,
    words, captions and metadata exchange `left` and `right` too; the person, the license and the
    source stay.
    - **resample** changes the frame rate; rotations are interpolated.
    - **in_place** removes the horizontal path of the hips. Heights and turns stay.
    - **loop** keeps the part whose end is followed best by its beginning: the pair of frames
    whose poses and velocities differ least, relative to how far the pose moves between them. The
    last 0.2 s are blended, so that repeats follow each other without a jump, each from where the
    last one ended.

    The new clip is a BVH file, which is analyzed like an upload. It has the labels of the
    original, its recording, and the beats and the annotated keyposes of the part; `origin` says
    where it comes from. The original may be deleted: the copy remains, and says so. No model
    learns from a copy while its original is there. The same edit of the same clip is stored once
    (200).

    name: Of the new clip. Default: the original's name and the steps.
    """
    from kinedex.types.clips import ClipCreated

    return Call(
        "edit_clip",
        "POST",
        path_of("/v1/clips/{clip_id}/edits", clip_id=clip_id),
        record(ClipCreated),
        json=given(steps=steps, name=name),
    )
