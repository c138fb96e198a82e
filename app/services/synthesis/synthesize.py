"""Synthesizes motions that nobody recorded (Vasilescu 2002, section 4).

The person is one of the library at another task, or the person of some given clips.
"""

from __future__ import annotations

import io
from dataclasses import dataclass, replace

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_shape import motion_shape
from app.errors import ModelNotFitted
from app.formats.bvh.export import write_animation_bvh
from app.models.synthesis.body import embody
from app.models.synthesis.model import Synthesis
from app.models.synthesis.motion import course_of
from app.motion.frame.body_frame import smooth_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation
from app.services import fields
from app.services.clips import catalogue as clips
from app.services.library.fitted_models import Fitted
from app.services.library.library import Library
from app.services.library.synthesized import SYNTHESIZED
from app.services.synthesis.donors import Material, material_of
from app.services.synthesis.plan import Plan, plan_of
from app.services.synthesis.quality import Quality, judge
from app.services.views.views import MotionView
from app.store.clips.record import ClipRecord
from app.store.jobs.record import JobRecord

SECONDS = (0.5, 60.0)
"""Bounds of the requested duration."""

MAX_CLIPS = 100
"""Largest number of clips of a new person."""


@dataclass(frozen=True, slots=True)
class SynthesisQuery:
    """A query for a synthesis, with either `person` or `clip_ids`.

    person: a known person; clip_ids: clips of one person; task: the task to synthesize; seconds:
    duration, by default the usual one of the task, or a few cycles; store: whether to keep the
    motion as a clip.
    """

    task: str
    person: str | None = None
    clip_ids: tuple[str, ...] | None = None
    seconds: float | None = None
    store: bool = False


@dataclass(frozen=True, slots=True)
class Synthesized:
    """A synthesized motion.

    person, task: its labels; name: for a file; clip, job: if it was stored; is_new: False if the
    same motion was stored before; bvh: content of the BVH file; cycles: number of cycles, 0 if
    it is not cyclic; license: that of all sources, None if they differ; roles: joint names by
    role.
    """

    person: str | None
    task: str
    name: str
    clip: ClipRecord | None
    job: JobRecord | None
    is_new: bool
    motion: Motion
    bvh: bytes
    cycles: int
    license: str | None
    quality: Quality

    @property
    def view(self) -> MotionView:
        """The motion to draw."""
        parents = tuple(self.motion.parents.tolist())
        return MotionView(self.motion.frame_rate, self.motion.names, parents, self.motion.positions)


def synthesize(lib: Library, query: SynthesisQuery) -> Synthesized:
    """Synthesize the motion of a query, and judge its quality.

    Raises BadField; NotFound for a person or task that the model does not know; ClipNotFound;
    ClipNotReady; NotEnoughLabels if the library lacks the clips for it; ModelNotFitted.
    """
    query = _tidied(query)
    fitted = _model(lib)
    plan = plan_of(lib, fitted.model, query.task, query.person, query.clip_ids)
    material = material_of(lib, fitted.model, plan)
    course = course_of(
        plan.shape,
        material.body_length,
        seconds=query.seconds,
        take=material.take,
        take_shape=material.take_shape,
    )
    animation = embody(course, material.donors)
    motion = _as_motion(animation, material.donors[0].joints)
    quality = judge(lib, fitted, plan, motion, motion_shape(active_part(smooth_track(motion))))
    made = Synthesized(
        person=plan.person,
        task=plan.task,
        # the name has no person, since the name of a forgotten person must not remain
        name=f"{plan.task} (synthesized)",
        clip=None,
        job=None,
        is_new=True,
        motion=motion,
        bvh=b"".join(write_animation_bvh(animation)),
        cycles=course.cycles,
        license=material.license,
        quality=quality,
    )
    return _stored(lib, made, material, plan) if query.store else made


def _tidied(query: SynthesisQuery) -> SynthesisQuery:
    task, person = fields.text("task", query.task), fields.text("person", query.person)
    if task is None:
        raise fields.bad_field("task", "must not be empty")
    query = replace(query, task=task, person=person)
    if (query.person is None) == (query.clip_ids is None):
        raise fields.bad_field("person", "send exactly one of person and clip_ids")
    if query.clip_ids is not None and not 1 <= len(query.clip_ids) <= MAX_CLIPS:
        raise fields.bad_field("clip_ids", f"must be 1 to {MAX_CLIPS} clips")
    if query.seconds is not None and not SECONDS[0] <= query.seconds <= SECONDS[1]:
        raise fields.bad_field("seconds", f"must be from {SECONDS[0]:g} to {SECONDS[1]:g}")
    return query


def _model(lib: Library) -> Fitted[Synthesis]:
    if not lib.settings.recognize_persons:
        raise ModelNotFitted(
            "Synthesis needs models of persons, and these are switched off"
            " (KINEDEX_RECOGNIZE_PERSONS)."
        )
    return lib.models.synthesis(lib.store)


def _as_motion(animation: Animation, joints: dict[JointRole, int]) -> Motion:
    return Motion(
        format="bvh",
        names=animation.skeleton.names,
        parents=animation.skeleton.parents,
        positions=np.ascontiguousarray(animation.positions(), dtype=np.float32),
        roles=joints,
        missing_roles=tuple(role for role in SUN_ROLES if role not in joints),
        frame_rate=animation.frame_rate,
        declared_frame_rate=animation.frame_rate,
        metres_per_unit=0.01,
    )


def _stored(lib: Library, made: Synthesized, material: Material, plan: Plan) -> Synthesized:
    """Store the motion as a clip. Its `source` marks it as synthesized."""
    values = {
        "name": made.name,
        "person": plan.person,
        "task": plan.task,
        "words": material.words,
        "license": made.license,
        "source": SYNTHESIZED,
        "unit": "cm",
        "roles": material.roles,
    }
    created = clips.create_clip(lib, io.BytesIO(made.bvh), f"{made.name}.bvh", values)
    return replace(made, clip=created.clip, job=created.job, is_new=created.is_new)
