"""Low-dimensional motions (Perera 2009)."""

from __future__ import annotations

from pydantic import Field

from app.analysis.low_dimensional.eigen_motion import Basis
from app.analysis.low_dimensional.plausibility import Fault, Implausible, Plausibility
from app.api.schemas.base import Fps, Incoming, Outgoing, Seconds
from app.api.schemas.views import Motion, Point, plain
from app.errors import BadField
from app.kinedex_error import Place
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.roles.joint_roles import JointRole
from app.services.views.low_dimensional import (
    MAX_MODEL_CLIPS,
    MAX_POSES,
    ModelPose,
    ReducedView,
    Reduction,
)

MAX_FAULTS = 1000


class ReductionFields(Incoming):
    """Number of dimensions of a low-dimensional motion, and the poses that span them."""

    dimensions: int | None = Field(
        None, ge=1, le=10**6, description="K', from 1 to the number of poses of the model."
    )
    basis: Basis = Field(
        Basis.KEYPOSE,
        description="Poses of the model: keyposes, or the same number at equal intervals.",
    )
    model_clips: str | None = Field(
        None,
        max_length=5000,
        description="Ids of the clips with the poses of the model, separated by commas, at most "
        f"{MAX_MODEL_CLIPS}. Default: the clip itself.",
    )
    poses: int | None = Field(
        None,
        ge=1,
        le=MAX_POSES,
        description="Poses per clip with `basis=uniform`. Default: the number of its keyposes.",
    )

    def as_reduction(self) -> Reduction:
        """Return the reduction for the service."""
        ids = [part.strip() for part in (self.model_clips or "").split(",")]
        return Reduction(self.dimensions, self.basis, [one for one in ids if one], self.poses)

    def reduction_if_any(self) -> Reduction | None:
        """Return the reduction, or None without `dimensions`.

        Raises BadField if another field of it has a value without `dimensions`. The default value
        is accepted, because forms send it.
        """
        if self.dimensions is not None:
            return self.as_reduction()
        if (self.basis, self.model_clips, self.poses) != (Basis.KEYPOSE, None, None):
            message = "is needed with basis, model_clips and poses"
            raise BadField(f"dimensions {message}", places=[Place("dimensions", message)])
        return None


class LowDimensionalQuery(ReductionFields):
    """Reduction and frame rate of a low-dimensional motion."""

    dimensions: int | None = Field(
        None,
        ge=1,
        le=10**6,
        description="K', from 1 to the number of poses of the model. Default: 3.",
    )
    fps: Fps | None = Field(
        None, description="The motion is resampled to this rate. Default: 30, its own rate."
    )


class AnimationQuery(ReductionFields):
    """The part of a clip that is shown, and its reduction."""

    start: Seconds | None = Field(None, description="Start of the part, seconds.")
    end: Seconds | None = Field(None, description="End of the part, seconds.")


class EigenPose(Outgoing):
    """A pose of the model."""

    clip_id: str
    time: float = Field(description="Seconds from the start of the clip.")
    point: Point = Field(
        description="Coordinates on the first three axes, body lengths (figs. 7, 8)."
    )

    @classmethod
    def of(cls, pose: ModelPose, point: list[float]) -> EigenPose:
        """The pose as the API shows it."""
        return cls(clip_id=pose.clip_id, time=pose.time, point=point)


class PoseFault(Outgoing):
    """A span of time in which the pose of a joint is implausible."""

    fault: Fault
    joint: JointRole
    start: float = Field(description="Seconds.")
    end: float
    worst: float = Field(description="Time of the largest excess, seconds.")
    beyond: float = Field(
        description="Largest excess over the limit: degrees, or body lengths for in_trunk."
    )

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
    """Poses that no body can take (figs. 13, 14), counted in frames at 30 Hz."""

    frames: int = Field(description="Number of frames with a fault.")
    share: float = Field(ge=0, le=1)
    original_frames: int = Field(description="The same number for the original motion.")
    original_share: float = Field(ge=0, le=1)
    faults: list[PoseFault] = Field(
        description=f"The first {MAX_FAULTS:,} faults, in the order of time."
    )

    @classmethod
    def of(cls, reduced: Plausibility, original: Plausibility) -> ImplausiblePoses:
        """The figures of the reduced and of the original motion."""
        frames = max(len(reduced.implausible), 1)
        return cls(
            frames=reduced.count,
            share=reduced.count / frames,
            original_frames=original.count,
            original_share=original.count / frames,
            faults=[PoseFault.of(fault) for fault in reduced.faults[:MAX_FAULTS]],
        )


class LowDimensionalFigures(Outgoing):
    """Errors and figures of a low-dimensional motion."""

    basis: Basis
    dimensions: int
    poses: int = Field(description="K, the number of poses of the model.")
    variance_kept: list[float] = Field(
        description="For K' = 1..K: share of the variance of the model's own poses (eq. 9)."
    )
    error: list[float] = Field(
        description="For K' = 1..K, meters: root mean square distance of the joints from the "
        "original joints, over all frames and the 13 joints."
    )
    eigen_poses: list[EigenPose]
    implausible: ImplausiblePoses

    @classmethod
    def of(cls, view: ReducedView) -> LowDimensionalFigures:
        """The figures as the API shows them."""
        reduced = view.reduced
        points = plain(reduced.eigen_poses)
        return cls(
            basis=reduced.basis,
            dimensions=reduced.dimensions,
            poses=reduced.model.poses,
            variance_kept=plain(reduced.variance_kept),
            error=plain(reduced.errors),
            eigen_poses=[
                EigenPose.of(pose, point) for pose, point in zip(reduced.poses, points, strict=True)
            ],
            implausible=ImplausiblePoses.of(view.plausibility, view.original_plausibility),
        )


class LowDimensional(LowDimensionalFigures, Motion):
    """A low-dimensional motion of the 13 joint roles.

    Its position, heading and size are those of the original motion.
    """

    eigen_motion: list[Point] = Field(
        description="(frames, 3): coordinates of each frame on the first three axes (fig. 9)."
    )
