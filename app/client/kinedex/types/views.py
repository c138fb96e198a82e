"""Answers: views. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Array, Record


@dataclass(frozen=True, slots=True)
class Convergence(Record):
    """Course of the alternating least squares, which stop when lambda hardly changes.

    errors: Share of the volume that the factors do not explain, by iteration.
    changes: Relative change of lambda, by iteration.
    converged: False if the maximum number of iterations was reached first.
    """

    errors: list[float]
    changes: list[float]
    converged: bool


@dataclass(frozen=True, slots=True, eq=False)
class SymbolSummary(Record):
    """The motion symbol: a left-to-right Gaussian hidden Markov model.

    means: (states, 26) features.
    variances: (states, 26).
    """

    states: int
    means: Array
    variances: Array


@dataclass(frozen=True, slots=True)
class Versions(Record):
    """The version that computed the descriptor."""

    analysis: int


@dataclass(frozen=True, slots=True, eq=False)
class VolumeFactors(Record):
    """Rank-1 factors of the motion sequence volume (Sun 2011).

    rho: Primary vector, (13,).
    epsilon: Secondary vector, (frames,) at 30 Hz.
    convergence: null if the clip was analyzed by an older version that did not store this.
    """

    lambda_: float
    rho: Array
    epsilon: Array
    convergence: Convergence | None


@dataclass(frozen=True, slots=True, eq=False)
class Descriptor(Record):
    """The arrays by which a clip is compared with others.

    motion_vector: (128,).
    """

    msv: VolumeFactors
    motion_vector: Array
    symbol: SymbolSummary
    versions: Versions


@dataclass(frozen=True, slots=True, eq=False)
class Motion(Record):
    """Joint positions over time.

    parents: Index of each joint's parent, -1 for a root.
    positions: (frames, joints, 3), meters, Y up.
    """

    frame_rate: float
    joint_names: list[str]
    parents: list[int]
    positions: Array
