"""Positions of joints as raw float32, the fastest form of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kinedex.errors import PackageNeeded

if TYPE_CHECKING:
    import httpx2
    import numpy as np
    import numpy.typing as npt


@dataclass(frozen=True, slots=True, eq=False)
class Positions:
    """A motion as an array.

    positions: (frames, joints, 3), float32, meters, Y up. frame_rate: frames per second.
    """

    positions: npt.NDArray[np.float32]
    frame_rate: float


def positions(response: httpx2.Response) -> Positions:
    """Read an answer of octets. Raises PackageNeeded without NumPy."""
    try:
        import numpy as np
    except ImportError:
        raise PackageNeeded("numpy", "An array") from None
    shape = [int(size) for size in response.headers["X-Shape"].split(",")]
    array = np.frombuffer(response.content, dtype="<f4").reshape(shape)
    return Positions(array, float(response.headers["X-Frame-Rate"]))
