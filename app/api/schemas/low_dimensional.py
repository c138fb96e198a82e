"""Motions drawn from few dimensions."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from app.analysis.low_dimensional.eigen_motion import Basis
from app.analysis.low_dimensional.plausibility import Fault, Implausible, Plausibility
from app.api.schemas.base import Fps, Incoming, Outgoing, Seconds
from app.api.schemas.views import Motion, Point, plain
from app.errors import BadField, Place
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.roles.joint_roles import JointRole
from app.services.views.low_dimensional import (
    MAX_MODEL_CLIPS,
    MAX_POSES,
    ModelPose,
    ReducedView,
    Reduction,
)

MOST_FAULTS = 1000


class ReductionFields(Incoming):
    """From how many dimensions a motion is drawn, and what spans them."""

    dimensions: int | None = Field(
        None, ge=1, le=10**6, description="K', from 1 to as many as the model has poses."
    )
    basis: Basis = Field(
        Basis.KEYPOSE, description="The model's poses: keyposes, or as many at equal times."
    )
    model_clips: str | None = Field(
        None,
        max_length=5000,
        description="Ids of the clips whose poses make the model, separated by commas, at most "
        f"{MAX_MODEL_CLIPS}; default: the clip itself.",
    )
    poses: int | None = Field(
        None,
        ge=1,
        le=MAX_POSES,
        description="Of each clip, with `basis=uniform`; default: as many as it has keyposes.",
    )

    def as_reduction(self) -> Reduction:
        """What the service is asked for."""
        ids = [part.strip() for part in (self.model_clips or "").split(",")]
        return Reduction(self.dimensions, self.basis, [one for one in ids if one], self.poses)

    def reduction_if_any(self) -> Reduction | None:
        """The same, or nothing where no dimensions are given. Raises BadField where only
        what goes with them is."""
        if self.dimensions is not None:
            return self.as_reduction()
        if {"basis", "model_clips", "poses"} & self.model_fields_set:
            message = "is needed with basis, model_clips and poses"
            raise BadField(f"dimensions {message}", places=[Place("dimensions", message)])
        return None


class LowDimensionalQuery(ReductionFields):
    """How a low-dimensional motion is returned."""

    dimensions: int | None = Field(
        None,
        ge=1,
        le=10**6,
        description="K', from 1 to as many as the model has poses; default: 3.",
    )
    fps: Fps | None = Field(
        None, description="Resampled by time; default: 30, at which it is made."
    )


class AnimationQuery(ReductionFields):
    """What of a clip is shown."""

    start: Seconds | None = Field(None, description="Seconds: where the part begins.")
    end: Seconds | None = Field(None, description="Seconds: where it ends.")


class EigenPose(Outgoing):
    """A pose that the model was made of."""

    clip_id: str
    time: float = Field(description="Seconds from the clip's beginning.")
    point: Point = Field(description="Along the first three axes, body lengths (figs 7, 8).")

    @classmethod
    def of(cls, pose: ModelPose, point: list[float]) -> EigenPose:
        """The pose as the API shows it."""
        return cls(clip_id=pose.clip_id, time=pose.time, point=point)


class PoseFault(Outgoing):
    """A stretch of time in which a joint does what no joint can do."""

    fault: Fault
    joint: JointRole
    start: float = Field(description="Seconds.")
    end: float
    worst: float = Field(description="Seconds: when it is worst.")
    beyond: float = Field(description="Then beyond the limit: degrees, body lengths for in_trunk.")

    @classmethod
    def of(cls, fault: Implausible) -> PoseFault:
        """The fault as the API shows it; frames become seconds."""
        return cls(
            fault=fault.fault,
            joint=fault.joint,
            start=fault.first / ANALYSIS_RATE,
            end=(fault.last + 1) / ANALYSIS_RATE,
            worst=fault.worst / ANALYSIS_RATE,
            beyond=fault.beyond,
        )


class ImplausiblePoses(Outgoing):
    """Poses that no body takes (figs 13, 14), of the frames at 30 Hz."""

    frames: int = Field(description="Frames with a fault.")
    share: float = Field(ge=0, le=1)
    original_frames: int = Field(description="The same of the original motion.")
    original_share: float = Field(ge=0, le=1)
    faults: list[PoseFault] = Field(description=f"By time; the first {MOST_FAULTS:,}.")

    @classmethod
    def of(cls, reduced: Plausibility, original: Plausibility) -> ImplausiblePoses:
        """The figures of the reduced and of the original motion."""
        frames = max(len(reduced.implausible), 1)
        return cls(
            frames=reduced.count,
            share=reduced.count / frames,
            original_frames=original.count,
            original_share=original.count / frames,
            faults=[PoseFault.of(fault) for fault in reduced.faults[:MOST_FAULTS]],
        )


class LowDimensionalFigures(Outgoing):
    """What few dimensions leave of a motion."""

    basis: Basis
    dimensions: int
    poses: int = Field(description="K: poses of the model.")
    variance_kept: list[float] = Field(
        description="At K' = 1..K, of the model's own poses (eq. 9); says nothing of the motion."
    )
    error: list[float] = Field(
        description="At K' = 1..K, metres: root mean square distance of the joints from the "
        "original's, over all frames and the 13 joints."
    )
    eigen_poses: list[EigenPose]
    implausible: ImplausiblePoses

    @classmethod
    def of(cls, view: ReducedView) -> LowDimensionalFigures:
        """The figures as the API shows them."""
        found = view.reduced
        points = plain(found.eigen_poses)
        return cls(
            basis=found.basis,
            dimensions=found.dimensions,
            poses=found.model.poses,
            variance_kept=plain(found.variance_kept),
            error=plain(found.errors),
            eigen_poses=[
                EigenPose.of(pose, point) for pose, point in zip(found.poses, points, strict=True)
            ],
            implausible=ImplausiblePoses.of(view.plausibility, view.original_plausibility),
        )

    def members(self) -> dict[str, Any]:
        """As JSON takes them."""
        return self.model_dump(mode="json")


class LowDimensional(LowDimensionalFigures, Motion):
    """A motion drawn from few dimensions: 13 joint roles in the original's place, heading and
    size."""

    eigen_motion: list[Point] = Field(
        description="(frames, 3): the motion's curve along the first three axes (fig. 9)."
    )
