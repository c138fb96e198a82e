"""What can be seen of a clip: its motion, keyposes and descriptor."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from app.api.schemas.base import Incoming, Outgoing

Point = Annotated[list[float], Field(min_length=3, max_length=3)]


class MotionQueryParameters(Incoming):
    """How a clip's motion is wanted."""

    fps: float | None = Field(
        None, ge=1, le=240, description="Resampled by time; default: the clip's own rate."
    )
    joints: Literal["all", "roles"] = Field(
        "all", description="All joints, or the 13 of Sun's figure 2 in its order."
    )


class Motion(Outgoing):
    """Joint positions over time."""

    frame_rate: float
    joint_names: list[str]
    parents: list[int] = Field(description="Index of each joint's parent, -1 for a root.")
    positions: list[list[Point]] = Field(description="(frames, joints, 3), metres, Y up.")


class KeyposeQuery(Incoming):
    """How keyposes are found."""

    method: Literal["rms", "printed"] = Field(
        "rms", description="RMS of joint speeds, or equations 1 and 2 as printed."
    )
    t1: float | None = Field(
        None, ge=0, le=100, description="Of the median local maximum; below it a minimum is small."
    )
    t2: float | None = Field(
        None, ge=0, le=100, description="Of the median local maximum; a drop beyond it is deep."
    )


class Energy(Outgoing):
    """Energy curves, a value a frame."""

    global_: list[float] = Field(alias="global", serialization_alias="global")
    local: list[float]


class Keyposes(Outgoing):
    """Poses at which a motion comes to rest on its beats."""

    method: str
    t1: float
    t2: float
    frame_rate: float = Field(description="Of `frames` and of the energy curves.")
    tempo: float | None = Field(description="Beats a minute; null where no beat was found.")
    beats: list[float] = Field(description="Seconds.")
    frames: list[int]
    times: list[float] = Field(description="Seconds.")
    roles: list[str] = Field(description="Order of the joints in `poses`.")
    poses: list[list[Point]] = Field(description="(keyposes, 13, 3), metres, Y up.")
    energy: Energy


class VolumeFactors(Outgoing):
    """Rank-1 factors of the motion sequence volume (Sun 2011)."""

    lambda_: float = Field(alias="lambda", serialization_alias="lambda")
    rho: list[float] = Field(description="Primary vector, (13,).")
    epsilon: list[float] = Field(description="Secondary vector, (frames,) at 30 Hz.")


class SymbolSummary(Outgoing):
    """The motion symbol: a left-to-right hidden Markov model."""

    states: int
    features: int


class Descriptor(Outgoing):
    """What a clip is compared by."""

    msv: VolumeFactors
    motion_vector: list[float]
    symbol: SymbolSummary | None
    versions: dict[str, int]
