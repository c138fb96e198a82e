"""Synthesis of motions that nobody recorded: request and answer."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from app.api.schemas.base import Incoming, Label, Outgoing, not_null
from app.api.schemas.clips import Clip
from app.api.schemas.jobs import Job
from app.api.schemas.query_source import ClipId
from app.api.schemas.views import Motion, plain
from app.services.library.synthesized import SYNTHESIZED
from app.services.synthesis.plan import SynthesisKind
from app.services.synthesis.synthesize import MAX_CLIPS, SECONDS, Synthesized


class Synthesize(Incoming):
    """The requested motion. Exactly one of `person` and `clip_ids` is needed."""

    task: Annotated[Label, Field(min_length=1, description="The task of the motion.")]
    person: Label | None = Field(
        None, description="A person of the library.", json_schema_extra=not_null
    )
    clip_ids: Annotated[list[ClipId], Field(min_length=1, max_length=MAX_CLIPS)] | None = Field(
        None,
        json_schema_extra=not_null,
        description="Clips of one person, labeled with their tasks. The library may know the person"
        " or not: the motion is made as if it had no other clips of that person.",
    )
    seconds: float | None = Field(
        None,
        ge=SECONDS[0],
        le=SECONDS[1],
        description="Duration, seconds. A gait is repeated to about this duration; any other motion"
        " is stretched to it. Default: a few cycles, or the usual duration of the task.",
    )
    store: bool = Field(False, description="Store the motion as a clip.")
    bvh: bool = Field(False, description="Include the BVH file in the answer.")

    model_config = ConfigDict(
        json_schema_extra={
            # Not `oneOf`: generators of clients take that for several types of the whole body.
            "if": {"not": {"required": ["person"]}},
            "then": {"required": ["clip_ids"]},
            "else": {"not": {"required": ["clip_ids"]}},
            "examples": [
                {"person": "PERSON", "task": "TASK"},
                {"clip_ids": ["CLIP_ID"], "task": "TASK", "store": True},
            ],
        }
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.person is None) == (self.clip_ids is None):
            raise ValueError("send exactly one of person and clip_ids")
        return self


class SynthesizedClip(Outgoing):
    """A synthesized motion as a clip. It has no id if it was not stored."""

    id: str | None
    name: str
    person: str | None
    task: str
    source: str = Field(description="`synthesized`.")
    license: str | None = Field(
        description="License of all clips that were used; null if they differ."
    )
    format: str
    frames: int
    frame_rate: float
    duration: float = Field(description="Seconds.")
    joints: int
    roles: dict[str, str] = Field(description="Joint name by joint role.")


class QualityWarning(Outgoing):
    """A reason not to trust a motion."""

    code: str = Field(description="`jerky` or `feet_slide`.")
    detail: str
    value: float = Field(description="Of the motion: m/s³ of jerk, or m/s of foot skate.")
    real: float = Field(description="Of real takes of the task, in the same unit.")


class Quality(Outgoing):
    """How similar the motion is to real clips, and how similar such motions usually are."""

    kind: SynthesisKind = Field(
        description="new_task: a known person in a new task. new_person: a person known only by"
        " `clip_ids`. seen: the person recorded this task, and the motion is the mean of these"
        " takes, or one of them if they differ too much."
    )
    given_persons: list[str] = Field(description="Persons who recorded the task.")
    given_tasks: list[str] = Field(description="Tasks that the requested person recorded.")
    follows: str | None = Field(
        description="If the takes of a task differ too much (dances), the motion follows "
        "the take of"
        " this person, with the style of the requested person. If null, the motion uses all takes."
    )
    agreement: float | None = Field(
        le=1,
        description="Share of the movement that is common to the persons' mean takes of "
        "the task (for"
        " `seen`: to the takes of the person). It is about 0 or slightly negative for dissimilar"
        " motions. Null if there is only one.",
    )
    nearest_clip: Clip | None = Field(
        validation_alias="nearest",
        description="The real clip that is most similar to the motion.",
    )
    nearest_person: str
    nearest_task: str
    distance: float = Field(
        ge=0, description="Distance from that clip, in body lengths over 32 moments."
    )
    person_is_right: bool | None = Field(
        description="Whether that clip shows the requested person; null if the person has no name."
        " If the person never recorded the task, the clip can hardly show both person and task."
    )
    task_is_right: bool = Field(description="Whether that clip shows the requested task.")
    expected_hit: float | None = Field(
        ge=0,
        le=1,
        description="How likely a real take of the same person and task, if there were one, would "
        "be the nearest real clip. Learned when the model was fitted, from combinations of person "
        "and task that were left out and synthesized, by the number of given persons or tasks, by "
        "`follows`, and by whether the nearest clip of others shows the task. Null for `seen`.",
    )
    expected_given: int | None = Field(
        description="Number of persons (new_task) or tasks (new_person) that it is for: that of "
        "this motion, or the largest number that was tried."
    )
    expected_trials: int | None = Field(
        description="Number of motions that were left out and synthesized to learn this."
    )
    real_hit: float | None = Field(
        ge=0,
        le=1,
        description="Share of real takes of such combinations whose nearest other clip is of the "
        "same combination: an upper bound for `expected_hit`. Null if none has two takes.",
    )
    skate: float = Field(
        ge=0, description="Foot skate: mean horizontal speed of feet near the floor, m/s."
    )
    real_skate: float | None = Field(description="The same speed in real takes of the task.")
    jerk: float = Field(
        ge=0,
        description="Root mean square, over frames and joints, of the third derivative of the "
        "positions, m/s³.",
    )
    real_jerk: float | None = Field(description="The same in real takes of the task.")
    warnings: list[QualityWarning] = Field(
        validation_alias="doubts",
        description="If the motion has more than twice the jerk or the foot skate of real takes of "
        "the task, do not use it as it is.",
    )


class Synthesis(Outgoing):
    """A motion that nobody recorded."""

    clip: SynthesizedClip | Clip = Field(description="The stored clip, or a clip without an id.")
    job: Job | None = Field(description="The job that makes the stored clip ready, else null.")
    cycles: int = Field(ge=0, description="Number of cycles of a gait, 0 for other motions.")
    quality: Quality
    motion: Motion
    bvh: str | None = Field(description="The BVH file if `bvh` was requested: centimeters, Y up.")

    @classmethod
    def of(cls, made: Synthesized, *, with_bvh: bool) -> Synthesis:
        """The synthesis as the API shows it."""
        view = made.view
        return cls(
            clip=_draft(made) if made.clip is None else Clip.model_validate(made.clip),
            job=None if made.job is None else Job.model_validate(made.job),
            cycles=made.cycles,
            quality=Quality.model_validate(made.quality),
            motion=Motion(
                frame_rate=view.frame_rate,
                joint_names=list(view.joint_names),
                parents=list(view.parents),
                positions=plain(view.positions),
            ),
            bvh=made.bvh.decode() if with_bvh else None,
        )


def _draft(made: Synthesized) -> SynthesizedClip:
    motion = made.motion
    return SynthesizedClip(
        id=None,
        name=made.name,
        person=made.person,
        task=made.task,
        source=SYNTHESIZED,
        license=made.license,
        format=motion.format,
        frames=motion.frames,
        frame_rate=motion.frame_rate,
        duration=motion.duration,
        joints=len(motion.names),
        roles={role.value: motion.names[joint] for role, joint in motion.roles.items()},
    )
