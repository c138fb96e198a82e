"""Answers: keyposes. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinedex.records import Array, Record


@dataclass(frozen=True, slots=True)
class Energy(Record):
    """Energy curves: one value for each frame, in body lengths per second."""

    global_: list[float]
    local: list[float]


@dataclass(frozen=True, slots=True)
class EnergyNoise(Record):
    """Energy that the noise of markers causes at rest, in body lengths per second.

    It is already subtracted from both curves.
    """

    global_: float
    local: float


@dataclass(frozen=True, slots=True)
class ThresholdSources(Record):
    """The sources of T1 and T2.

    model_version: Version of the model with the learned thresholds, if they are used. null if a
    newer one has learned others: then the clip waits for its new analysis.
    """

    t1: Literal["given", "learned", "default"]
    t2: Literal["given", "learned", "default"]
    model_version: int | None


@dataclass(frozen=True, slots=True, eq=False)
class Keyposes(Record):
    """Poses at which a motion comes to rest, near its beats if it has beats, or turns back.

    frame_rate: Frames per second of `frames` and of the energy curves.
    tempo: Beats per minute; null if no beat was detected. From the motion alone it is rarely
    found in recorded dances: send `tempo`, `beats` or a recording.
    beats: Seconds.
    beats_source: The source of the beats. Keyposes are searched only near beats from `given`,
    `tempo` or `audio`. Beats from `motion` only select a moment within a rest.
    beats_confidence: 0 to 1: for beats from `audio`, the probability that their phase and level
    are those of the dance; for others, the confidence that they are not accidental.
    times: Seconds.
    chosen_by: What makes each pose a keypose: a minimum of the energy relative to the floor
    (global) or to the waist (local); or it is the far end of a movement that returns to the
    pose it left, such as a strike (turn).
    roles: Order of the joints in `poses`.
    poses: (keyposes, 13, 3), meters, Y up.
    annotated: Times of the keyposes that a person named, seconds; null if there are none.
    """

    method: str
    weights: str
    t1: float
    t2: float
    thresholds: ThresholdSources
    frame_rate: float
    tempo: float | None
    beats: list[float]
    beats_source: Literal["given", "tempo", "audio", "motion", "none"]
    beats_confidence: float
    frames: list[int]
    times: list[float]
    chosen_by: list[Literal["global", "local", "turn"]]
    roles: list[str]
    poses: Array
    energy: Energy
    energy_unit: str
    noise: EnergyNoise
    annotated: list[float] | None


@dataclass(frozen=True, slots=True)
class KeyposesNamed(Record):
    """The stored keyposes.

    times: Seconds, in rising order.
    """

    times: list[float]
