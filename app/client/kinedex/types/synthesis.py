"""Answers: synthesis. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Record
from kinedex.types.choices import SynthesisKind
from kinedex.types.clips import Clip
from kinedex.types.jobs import Job
from kinedex.types.views import Motion


@dataclass(frozen=True, slots=True)
class QualityWarning(Record):
    """A reason not to trust a motion.

    code: `jerky` or `feet_slide`.
    value: Of the motion: m/s³ of jerk, or m/s of foot skate.
    real: Of real takes of the task, in the same unit.
    """

    code: str
    detail: str
    value: float
    real: float


@dataclass(frozen=True, slots=True)
class Quality(Record):
    """How similar the motion is to real clips, and how similar such motions usually are.

    kind: new_task: a known person in a new task. new_person: a person known only by `clip_ids`.
    seen: the person recorded this task, and the motion is the mean of these takes, or one of
    them if they differ too much.
    given_persons: Persons who recorded the task.
    given_tasks: Tasks that the requested person recorded.
    follows: If the takes of a task differ too much (dances), the motion follows the take of
    this person, with the style of the requested person. If null, the motion uses all takes.
    agreement: Share of the movement that is common to the persons' mean takes of the task (for
    `seen`: to the takes of the person). It is about 0 or slightly negative for dissimilar
    motions. Null if there is only one.
    nearest_clip: The real clip that is most similar to the motion.
    distance: Distance from that clip, in body lengths over 32 moments.
    person_is_right: Whether that clip shows the requested person; null if the person has no
    name. If the person never recorded the task, the clip can hardly show both person and task.
    task_is_right: Whether that clip shows the requested task.
    expected_hit: How likely a real take of the same person and task, if there were one, would
    be the nearest real clip. Learned when the model was fitted, from combinations of person and
    task that were left out and synthesized, by the number of given persons or tasks, by
    `follows`, and by whether the nearest clip of others shows the task. Null for `seen`.
    expected_given: Number of persons (new_task) or tasks (new_person) that it is for: that of
    this motion, or the largest number that was tried.
    expected_trials: Number of motions that were left out and synthesized to learn this.
    real_hit: Share of real takes of such combinations whose nearest other clip is of the same
    combination: an upper bound for `expected_hit`. Null if none has two takes.
    skate: Foot skate: mean horizontal speed of feet near the floor, m/s.
    real_skate: The same speed in real takes of the task.
    jerk: Root mean square, over frames and joints, of the third derivative of the positions,
    m/s³.
    real_jerk: The same in real takes of the task.
    warnings: If the motion has more than twice the jerk or the foot skate of real takes of the
    task, do not use it as it is.
    """

    kind: SynthesisKind
    given_persons: list[str]
    given_tasks: list[str]
    follows: str | None
    agreement: float | None
    nearest_clip: Clip | None
    nearest_person: str
    nearest_task: str
    distance: float
    person_is_right: bool | None
    task_is_right: bool
    expected_hit: float | None
    expected_given: int | None
    expected_trials: int | None
    real_hit: float | None
    skate: float
    real_skate: float | None
    jerk: float
    real_jerk: float | None
    warnings: list[QualityWarning]


@dataclass(frozen=True, slots=True)
class SynthesizedClip(Record):
    """A synthesized motion as a clip. It has no id if it was not stored.

    source: `synthesized`.
    license: License of all clips that were used; null if they differ.
    duration: Seconds.
    roles: Joint name by joint role.
    """

    id: str | None
    name: str
    person: str | None
    task: str
    source: str
    license: str | None
    format: str
    frames: int
    frame_rate: float
    duration: float
    joints: int
    roles: dict[str, str]


@dataclass(frozen=True, slots=True)
class Synthesis(Record):
    """A motion that nobody recorded.

    clip: The stored clip, or a clip without an id.
    job: The job that makes the stored clip ready, else null.
    cycles: Number of cycles of a gait, 0 for other motions.
    bvh: The BVH file if `bvh` was requested: centimeters, Y up.
    """

    clip: SynthesizedClip | Clip
    job: Job | None
    cycles: int
    quality: Quality
    motion: Motion
    bvh: str | None
