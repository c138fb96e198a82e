"""Calls: recognize. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given

if TYPE_CHECKING:
    from kinedex.types.recognition import Recognition


def recognize(
    clip_id: str | None = None,
    *,
    file: FileInput | None = None,
    skeleton: FileInput | None = None,
    unit: str | None = None,
    frame_rate: float | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    roles: str | Mapping[str, Any] | None = None,
    stack: str | None = None,
    method: Literal["default", "multilinear", "signatures", "perera"] | None = None,
    known_person: str | None = None,
    known_task: str | None = None,
    word_mode: Literal["default", "cca", "printed"] | None = None,
    progress: Progress | None = None,
) -> Call[Recognition]:
    """Recognize person, task and words of a motion. `label` is null if it is unknown.

    file: The query motion, in any format that an upload may have. It is never stored.
    skeleton: The ASF file that an AMC file needs.
    unit: m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.
    frame_rate: It replaces the frame rate that the file declares.
    up_axis: The axis of the file that points up. Without it, the axis that the file says is
        used, else the one along which the body stands: then the clip has the warning
        `up_axis_guessed`.
    roles: JSON: joint name by role, as in {"hips": "Pelvis"}; a list of two names is for their
        middle, as in {"hips": ["LHip", "RHip"]}. A body that seems to be an animal is refused as
        `skeleton_not_human`, with the reasons, unless roles are sent.
    stack: The name of the animation stack to read, if an FBX file has several; default: the
        longest. The clip's warning `stack_chosen` lists them.
    method: The recognizer. signatures: Vasilescu 2002, on joint angles. multilinear: the same on
        positions. perera: weighted distances of joints, Perera 2009. Default: default.
    known_person: Recognize the task given the person. If the library does not know it, it counts
        as new, and its label in the answer is null.
    known_task: Recognize the person given the task. If the library does not know it, it counts
        as new, and its label in the answer is null.
    word_mode: How words are predicted: as in a search by words. Default: default.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.recognition import Recognition

    return Call(
        "recognize",
        "POST",
        "/v1/recognize",
        record(Recognition),
        json=given(
            clip_id=clip_id,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            method=method,
            known_person=known_person,
            known_task=known_task,
            word_mode=word_mode,
        ),
        fields=given(
            clip_id=clip_id,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            method=method,
            known_person=known_person,
            known_task=known_task,
            word_mode=word_mode,
        ),
        files=given(file=file, skeleton=skeleton),
        progress=progress,
    )
