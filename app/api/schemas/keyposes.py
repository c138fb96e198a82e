"""Keyposes: found, with what they were found from, and named by people."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from app.api.schemas.base import Incoming, Outgoing, Seconds
from app.api.schemas.views import Point, plain
from app.motion.roles.joint_roles import SUN_ROLES
from app.services.fields import MAX_KEYPOSES
from app.services.views.keyposes import KeyposesView

Source = Literal["given", "learned", "default"]


class KeyposeQuery(Incoming):
    """How keyposes are found."""

    method: Literal["rms", "printed"] = Field(
        "rms", description="RMS of joint speeds, or equations 1 and 2 as printed."
    )
    weights: Literal["uniform", "mass"] = Field(
        "uniform", description="Joints count alike, or by the mass that moves with them (fig. 6)."
    )
    t1: float | None = Field(
        None, gt=0, le=100, description="Of the median local maximum; below it a minimum is small."
    )
    t2: float | None = Field(
        None, gt=0, le=100, description="Of the median local maximum; a drop beyond it is deep."
    )


class Energy(Outgoing):
    """Energy curves: one value for each frame, in body lengths per second."""

    global_: list[float] = Field(alias="global")
    local: list[float]


class EnergyNoise(Outgoing):
    """The energy that shaking markers have at rest, in body lengths per second.

    It has been subtracted from both curves.
    """

    global_: float = Field(alias="global")
    local: float


class ThresholdSources(Outgoing):
    """Where T1 and T2 come from."""

    t1: Source
    t2: Source
    model_version: int | None = Field(description="Of the learned thresholds, where they count.")


class Keyposes(Outgoing):
    """Poses at which a motion comes to rest, on its beats where it has any."""

    method: str
    weights: str
    t1: float
    t2: float
    thresholds: ThresholdSources
    frame_rate: float = Field(description="Of `frames` and of the energy curves.")
    tempo: float | None = Field(description="Beats a minute; null where no beat was found.")
    beats: list[float] = Field(description="Seconds.")
    beats_source: Literal["given", "tempo", "audio", "motion", "none"] = Field(
        description="Where the beats come from. Keyposes are sought only on beats that are "
        "`given`, or from `tempo` or `audio`; beats from `motion` only select a moment within a "
        "rest."
    )
    beats_confidence: float = Field(description="0 to 1: how surely they are no accident.")
    frames: list[int]
    times: list[float] = Field(description="Seconds.")
    chosen_by: list[Literal["global", "local"]] = Field(
        description="Which energy chose each: seen from the floor, or from the waist."
    )
    roles: list[str] = Field(description="Order of the joints in `poses`.")
    poses: list[list[Point]] = Field(description="(keyposes, 13, 3), metres, Y up.")
    energy: Energy
    energy_unit: str = "body lengths per second"
    noise: EnergyNoise
    annotated: list[float] | None = Field(
        description="Seconds: the keyposes that a person named; null where nobody did."
    )

    @classmethod
    def of(cls, view: KeyposesView) -> Keyposes:
        """The keyposes as the API shows them."""
        found, used = view.found, view.thresholds
        whole, own = found.energies.global_curve, found.energies.local_curve
        return cls(
            method=found.method.value,
            weights=found.weights.value,
            t1=found.t1,
            t2=found.t2,
            thresholds=ThresholdSources(
                t1=used.t1_source.value,
                t2=used.t2_source.value,
                model_version=used.model_version,
            ),
            frame_rate=view.frame_rate,
            tempo=found.beats.tempo,
            beats=plain(found.beats.times),
            beats_source=found.beats.source.value,
            beats_confidence=found.beats.confidence,
            frames=found.frames.tolist(),
            times=plain(found.times),
            chosen_by=[scope.value for scope in found.chosen_by],
            roles=[role.value for role in SUN_ROLES],
            poses=plain(view.poses),
            energy=Energy(**{"global": plain(whole.values)}, local=plain(own.values)),
            noise=EnergyNoise(**{"global": whole.noise}, local=own.noise),
            annotated=None if view.named is None else list(view.named),
        )


class NamedKeyposes(Incoming):
    """Keyposes that a person names; none of them take away what was named before."""

    times: list[Seconds] = Field(
        max_length=MAX_KEYPOSES,
        description="Seconds from the clip's beginning, in any order.",
        examples=[[0.8, 1.4, 2.1]],
    )


class KeyposesNamed(Outgoing):
    """What is stored."""

    times: list[float] = Field(description="Seconds, rising.")
