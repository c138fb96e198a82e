"""Keyposes that Kinedex finds, with beats and energies, and keyposes that a person names."""

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
    """The method and thresholds that find keyposes."""

    method: Literal["rms", "printed"] = Field(
        "rms", description="RMS of joint speeds, or equations 1 and 2 as printed."
    )
    weights: Literal["uniform", "mass"] = Field(
        "uniform",
        description="Weights of the joints: all equal, or the mass that moves with each (fig. 6).",
    )
    t1: float | None = Field(
        None,
        gt=0,
        le=100,
        description="A minimum below this share of the median local maximum is a rest.",
    )
    t2: float | None = Field(
        None,
        gt=0,
        le=100,
        description="A drop by more than this share of the median local maximum is a rest.",
    )


class Energy(Outgoing):
    """Energy curves: one value for each frame, in body lengths per second."""

    global_: list[float] = Field(alias="global")
    local: list[float]


class EnergyNoise(Outgoing):
    """Energy that the noise of markers causes at rest, in body lengths per second.

    It is already subtracted from both curves.
    """

    global_: float = Field(alias="global")
    local: float


class ThresholdSources(Outgoing):
    """The sources of T1 and T2."""

    t1: Source
    t2: Source
    model_version: int | None = Field(
        description="Version of the model with the learned thresholds, if they are used. null if a "
        "newer one has learned others: then the clip waits for its new analysis."
    )


class Keyposes(Outgoing):
    """Poses at which a motion comes to rest, near its beats if it has beats, or turns back."""

    method: str
    weights: str
    t1: float
    t2: float
    thresholds: ThresholdSources
    frame_rate: float = Field(description="Frames per second of `frames` and of the energy curves.")
    tempo: float | None = Field(
        description="Beats per minute; null if no beat was detected. From the motion alone it is "
        "rarely found in recorded dances: send `tempo`, `beats` or a recording."
    )
    beats: list[float] = Field(description="Seconds.")
    beats_source: Literal["given", "tempo", "audio", "motion", "none"] = Field(
        description="The source of the beats. Keyposes are searched only near beats from `given`, "
        "`tempo` or `audio`. Beats from `motion` only select a moment within a rest."
    )
    beats_confidence: float = Field(
        description="0 to 1: for beats from `audio`, the probability that their phase and level "
        "are those of the dance; for others, the confidence that they are not accidental."
    )
    frames: list[int]
    times: list[float] = Field(description="Seconds.")
    chosen_by: list[Literal["global", "local", "turn"]] = Field(
        description="What makes each pose a keypose: a minimum of the energy relative to the floor "
        "(global) or to the waist (local); or it is the far end of a movement that returns to the "
        "pose it left, such as a strike (turn)."
    )
    roles: list[str] = Field(description="Order of the joints in `poses`.")
    poses: list[list[Point]] = Field(description="(keyposes, 13, 3), meters, Y up.")
    energy: Energy
    energy_unit: str = "body lengths per second"
    noise: EnergyNoise
    annotated: list[float] | None = Field(
        description="Times of the keyposes that a person named, seconds; null if there are none."
    )

    @classmethod
    def of(cls, view: KeyposesView) -> Keyposes:
        """The keyposes as the API shows them."""
        detected, used = view.found, view.thresholds
        curves = detected.energies
        global_energy, local_energy = curves.global_curve, curves.local_curve
        return cls(
            method=detected.method.value,
            weights=detected.weights.value,
            t1=detected.t1,
            t2=detected.t2,
            thresholds=ThresholdSources(
                t1=used.t1_source.value,
                t2=used.t2_source.value,
                model_version=used.model_version,
            ),
            frame_rate=view.frame_rate,
            tempo=detected.beats.tempo,
            beats=plain(detected.beats.times),
            beats_source=detected.beats.source.value,
            beats_confidence=detected.beats.confidence,
            frames=detected.frames.tolist(),
            times=plain(detected.times),
            chosen_by=[scope.value for scope in detected.chosen_by],
            roles=[role.value for role in SUN_ROLES],
            poses=plain(view.poses),
            energy=Energy(
                **{"global": plain(global_energy.values)}, local=plain(local_energy.values)
            ),
            noise=EnergyNoise(**{"global": global_energy.noise}, local=local_energy.noise),
            annotated=None if view.named is None else list(view.named),
        )


class NamedKeyposes(Incoming):
    """Keyposes that a person names. They replace earlier ones; an empty list deletes them."""

    times: list[Seconds] = Field(
        max_length=MAX_KEYPOSES,
        description="Seconds from the start of the clip, in any order.",
        examples=[[0.8, 1.4, 2.1]],
    )


class KeyposesNamed(Outgoing):
    """The stored keyposes."""

    times: list[float] = Field(description="Seconds, in rising order.")
