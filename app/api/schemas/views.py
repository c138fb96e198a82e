"""Views of a clip: its motion and descriptor."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from app.api.schemas.base import Fps, Incoming, Outgoing
from app.numerics.tensors.rank1 import MAX_ITERATIONS
from app.services.views.views import DescriptorView
from app.services.volume_options import MAX_ETA, MAX_SLICES, VolumeOptions

Point = Annotated[list[float], Field(min_length=3, max_length=3)]


class MotionQueryParameters(Incoming):
    """Frame rate and joints of a returned motion."""

    fps: Fps | None = Field(
        None, description="The motion is resampled to this rate. Default: the clip's own rate."
    )
    joints: Literal["all", "roles"] = Field(
        "all", description="All joints, or the 13 joints of figure 2 in Sun 2011, in its order."
    )


class VolumeParameters(Incoming):
    """How the distances between joints are measured (Sun 2011, equations 1 and 2)."""

    q: int = Field(2, ge=1, le=2, description="The norm of the distances, 1 or 2.")
    eta: float = Field(
        0.0,
        ge=0,
        le=MAX_ETA,
        allow_inf_nan=False,
        description="Above 0: a cell is dark where two joints are at most this many body lengths "
        "apart. 0: the darker, the farther apart.",
    )

    def options(self) -> VolumeOptions:
        """The options of the services."""
        return VolumeOptions(self.q, self.eta)


class MatrixParameters(VolumeParameters):
    """One self-similarity matrix."""

    time: float | None = Field(
        None,
        ge=0,
        allow_inf_nan=False,
        description="Seconds: the moment of the matrix. Default: the middle of the active part.",
    )


class SlicesParameters(VolumeParameters):
    """Some slices of a motion volume."""

    slices: int = Field(
        10, ge=2, le=MAX_SLICES, description="Number of slices, evenly over the active part."
    )


class Motion(Outgoing):
    """Joint positions over time."""

    frame_rate: float
    joint_names: list[str]
    parents: list[int] = Field(description="Index of each joint's parent, -1 for a root.")
    positions: list[list[Point]] = Field(description="(frames, joints, 3), meters, Y up.")


class Convergence(Outgoing):
    """Course of the alternating least squares, which stop when lambda hardly changes."""

    errors: list[float] = Field(
        description="Share of the volume that the factors do not explain, by iteration."
    )
    changes: list[float] = Field(description="Relative change of lambda, by iteration.")
    converged: bool = Field(
        description="False if the maximum number of iterations was reached first."
    )

    @classmethod
    def of(cls, steps: NDArray[Any]) -> Convergence:
        """Make it from errors and changes, (iterations, 2)."""
        errors, changes = plain(steps.T)
        return cls(errors=errors, changes=changes, converged=len(errors) < MAX_ITERATIONS)


class VolumeFactors(Outgoing):
    """Rank-1 factors of the motion sequence volume (Sun 2011)."""

    lambda_: float = Field(alias="lambda")
    rho: list[float] = Field(description="Primary vector, (13,).")
    epsilon: list[float] = Field(description="Secondary vector, (frames,) at 30 Hz.")
    convergence: Convergence | None = Field(
        description="null if the clip was analyzed by an older version that did not store this."
    )


class SymbolSummary(Outgoing):
    """The motion symbol: a left-to-right Gaussian hidden Markov model."""

    states: int
    means: list[list[float]] = Field(description="(states, 26) features.")
    variances: list[list[float]] = Field(description="(states, 26).")


class Versions(Outgoing):
    """The version that computed the descriptor."""

    analysis: int


class Descriptor(Outgoing):
    """The arrays by which a clip is compared with others."""

    msv: VolumeFactors
    motion_vector: list[float] = Field(description="(128,).")
    symbol: SymbolSummary
    versions: Versions

    @classmethod
    def of(cls, view: DescriptorView) -> Descriptor:
        """The descriptor as the API shows it."""
        return cls(
            msv=VolumeFactors(
                **{"lambda": view.msv_lambda},
                rho=plain(view.msv_rho),
                epsilon=plain(view.msv_epsilon),
                convergence=(
                    None if view.msv_convergence is None else Convergence.of(view.msv_convergence)
                ),
            ),
            motion_vector=plain(view.motion_vector),
            symbol=SymbolSummary(
                states=view.symbol_states,
                means=plain(view.symbol_means),
                variances=plain(view.symbol_variances),
            ),
            versions=Versions(analysis=view.analysis_version),
        )


def plain(values: NDArray[Any]) -> Any:
    """Return an array as nested lists of float64, without rounding."""
    return values.astype(np.float64).tolist()
