"""Calls: synthesize. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinedex.call import OCTETS, Call, record
from kinedex.positions import Positions, positions
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.synthesis import Synthesis


def synthesize(
    task: str,
    *,
    person: str | None = None,
    clip_ids: Sequence[str] | None = None,
    seconds: float | None = None,
    store: bool | None = None,
    bvh: bool | None = None,
) -> Call[Synthesis]:
    """Make a motion that nobody recorded (Vasilescu 2002, section 4). With `person`, it is the
    motion of a person of the library for a task that only others did. With `clip_ids`, it is the
    motion of somebody of whom there are some clips. The motion uses the skeleton of one of the
    person's files.

    `quality` says what to expect. It names the real clip that is most similar to the motion. It
    also says how often such motions, made from equally little data, were recognized as the right
    person and task when the model was fitted. The quality is better if more persons did the
    task, and if the person did more tasks.

    With `store`, the motion becomes a clip (201) with the source `synthesized`. No model learns
    from it. `Accept: application/octet-stream` returns only the positions.

    task: The task of the motion.
    person: A person of the library.
    clip_ids: Clips of one person, labeled with their tasks. The library may know the person or
        not: the motion is made as if it had no other clips of that person.
    seconds: Duration, seconds. A gait is repeated to about this duration; any other motion is
        stretched to it. Default: a few cycles, or the usual duration of the task.
    store: Store the motion as a clip. Default: False.
    bvh: Include the BVH file in the answer. Default: False.
    """
    from kinedex.types.synthesis import Synthesis

    return Call(
        "synthesize",
        "POST",
        "/v1/synthesize",
        record(Synthesis),
        json=given(
            task=task, person=person, clip_ids=clip_ids, seconds=seconds, store=store, bvh=bvh
        ),
    )


def synthesize_array(
    task: str,
    *,
    person: str | None = None,
    clip_ids: Sequence[str] | None = None,
    seconds: float | None = None,
    store: bool | None = None,
    bvh: bool | None = None,
) -> Call[Positions]:
    """Make a motion that nobody recorded (Vasilescu 2002, section 4). With `person`, it is the
    motion of a person of the library for a task that only others did. With `clip_ids`, it is the
    motion of somebody of whom there are some clips. The motion uses the skeleton of one of the
    person's files. The answer is an array.

    `quality` says what to expect. It names the real clip that is most similar to the motion. It
    also says how often such motions, made from equally little data, were recognized as the right
    person and task when the model was fitted. The quality is better if more persons did the
    task, and if the person did more tasks.

    With `store`, the motion becomes a clip (201) with the source `synthesized`. No model learns
    from it. `Accept: application/octet-stream` returns only the positions.

    task: The task of the motion.
    person: A person of the library.
    clip_ids: Clips of one person, labeled with their tasks. The library may know the person or
        not: the motion is made as if it had no other clips of that person.
    seconds: Duration, seconds. A gait is repeated to about this duration; any other motion is
        stretched to it. Default: a few cycles, or the usual duration of the task.
    store: Store the motion as a clip. Default: False.
    bvh: Include the BVH file in the answer. Default: False.
    """
    return Call(
        "synthesize",
        "POST",
        "/v1/synthesize",
        positions,
        json=given(
            task=task, person=person, clip_ids=clip_ids, seconds=seconds, store=store, bvh=bvh
        ),
        accept=OCTETS,
    )
