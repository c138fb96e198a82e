"""Motions that nobody recorded: the request for one, and the answer."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from app.api.schemas.base import Incoming, Label, Outgoing
from app.api.schemas.clips import Clip
from app.api.schemas.jobs import Job
from app.api.schemas.query_source import ClipId
from app.api.schemas.views import Motion, plain
from app.services.library.synthesized import SYNTHESIZED
from app.services.synthesis.plan import SynthesisKind
from app.services.synthesis.synthesize import MAX_CLIPS, SECONDS, Synthesized


class Synthesize(Incoming):
    """Exactly one of `person`, whom the library knows, and `clip_ids`, of one person."""

    task: Annotated[Label, Field(min_length=1, description="What they are to do.")]
    person: Label | None = Field(None, description="A person of the library.")
    clip_ids: Annotated[list[ClipId], Field(min_length=1, max_length=MAX_CLIPS)] | None = Field(
        None,
        description="Clips of one person, known or not, labelled with what is done in them; the"
        " motion is made as though the library held no others of that person.",
    )
    seconds: float | None = Field(
        None,
        ge=SECONDS[0],
        le=SECONDS[1],
        description="How long: a gait is repeated to about that, anything else is stretched to"
        " it. Default: some cycles, or as long as the task takes.",
    )
    store: bool = Field(False, description="Keep the motion as a clip.")
    bvh: bool = Field(False, description="Include the BVH file in the answer.")

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"person": "anna", "task": "run"},
                {"clip_ids": ["CLIP_ID"], "task": "run", "store": True},
            ]
        }
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.person is None) == (self.clip_ids is None):
            raise ValueError("send exactly one of person and clip_ids")
        return self


class SynthesizedClip(Outgoing):
    """The clip that the motion is; without an id where it was not stored."""

    id: str | None
    name: str
    person: str | None
    task: str
    source: str = Field(description="`synthesized`.")
    license: str | None = Field(description="That of all clips it is made of, null if they differ.")
    format: str
    frames: int
    frame_rate: float
    duration: float = Field(description="Seconds.")
    joints: int
    roles: dict[str, str] = Field(description="Joint name by joint role.")


class Quality(Outgoing):
    """How far the motion can be trusted."""

    kind: SynthesisKind = Field(
        description="`new_task` of a known person; `new_person` of some clips; `seen`: the person"
        " did record this task, and the motion is the mean of their takes, or one of them where"
        " these do not agree."
    )
    given_persons: list[str] = Field(description="Who did the task.")
    given_tasks: list[str] = Field(description="What the asked person did.")
    follows: str | None = Field(
        description="The person whose take the motion follows, in the asked person's bearing, where"
        " the takes of the task do not agree on what it is (dances); else null, and the motion is"
        " made of all of them."
    )
    agreement: float | None = Field(
        le=1,
        description="Share of their movement that those takes have in common, persons' means side"
        " by side, or of `seen` the takes; about 0, or a little less, of unlike motions. Null where"
        " there is but one.",
    )
    nearest_clip: Clip | None = Field(
        validation_alias="nearest",
        description="The real clip most like the motion, analyzed like any other.",
    )
    nearest_person: str
    nearest_task: str
    distance: float = Field(ge=0, description="From it, in body lengths over 32 moments.")
    person_is_right: bool | None = Field(
        description="Whether that clip is of the person asked for; null where they have no name."
        " Where they never did the task it can hardly be both they and the task."
    )
    task_is_right: bool = Field(description="Whether it is of the task asked for.")
    expected_hit: float | None = Field(
        ge=0,
        le=1,
        description="Measured when the model was fitted: combinations of person and task were"
        " left out and made; this share of the motions had a take of just that combination as"
        " the nearest real clip. Of motions that followed one take as this one does, or did not as"
        " this one does not. Null for `seen`.",
    )
    expected_given: int | None = Field(
        description="From so many persons' takes (new_task) or tasks (new_person)."
    )
    expected_trials: int | None = Field(description="Combinations left out.")
    real_hit: float | None = Field(
        ge=0,
        le=1,
        description="That share of their real takes, each beside all others: no motion can be"
        " expected to do better. Null where there are no two takes.",
    )
    skate: float = Field(ge=0, description="Mean horizontal speed of low feet, m/s.")
    real_skate: float | None = Field(description="The same of real takes of the task.")


class Synthesis(Outgoing):
    """A motion that nobody recorded."""

    clip: SynthesizedClip | Clip = Field(description="As stored, or without an id.")
    job: Job | None = Field(description="That makes the stored clip ready, else null.")
    cycles: int = Field(ge=0, description="How often it goes round, 0 where it does not.")
    quality: Quality
    motion: Motion
    bvh: str | None = Field(description="The BVH file where it was asked for: centimetres, Y up.")

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
