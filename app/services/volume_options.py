"""How the methods msv-dtw and msv-xcorr compare motion volumes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from app.search.example.methods import Method
from app.services import fields

METHODS = (Method.MSV_DTW, Method.MSV_XCORR)
MAX_CLIPS = 1000
"""The most clips whose factors are computed for one search: 20 ms each on an idle machine."""
MAX_SLICES = 24
"""The most slices of a picture of a volume."""
NORMALIZED_SCALE = 0.007
"""Distance by the normalized D_xcorr with a score of 0.5: the median of two real clips of different
tasks."""
MAX_ETA = 100.0
"""Body lengths. Far above any distance of two joints."""


@dataclass(frozen=True, slots=True)
class VolumeOptions:
    """Options of Sun 2011; the default ones are those of the stored volumes.

    q: 1 or 2, the norm of distances between joints (equation 2). eta: if it is above 0, a cell of a
    self-similarity matrix is 1 where the distance is at most eta body lengths, else 0 (section
    3.1). normalized: D_xcorr without the ratio of the lengths, see `cross_correlations`.
    """

    q: int = 2
    eta: float = 0.0
    normalized: bool = False

    @property
    def are_stored(self) -> bool:
        """Whether the stored factors are those of these options."""
        return self.q == 2 and self.eta == 0.0

    def check_values(self) -> None:
        """Raise BadField if q or eta is wrong."""
        if self.q not in (1, 2):
            raise fields.bad_field("q", "must be 1 or 2")
        if not (math.isfinite(self.eta) and 0.0 <= self.eta <= MAX_ETA):
            raise fields.bad_field("eta", f"must be 0 to {MAX_ETA:g} body lengths")

    def check(self, method: Method, scope: str) -> None:
        """Raise BadField if the options are wrong, or do not go with the method or the scope."""
        self.check_values()
        if not self.are_stored and (method not in METHODS or scope != "clips"):
            known = " and ".join(METHODS)
            name = "q" if self.q != 2 else "eta"
            raise fields.bad_field(name, f"is for the methods {known} with scope clips")
        if self.normalized and (method is not Method.MSV_XCORR or scope != "clips"):
            raise fields.bad_field("normalized", "is for the method msv-xcorr with scope clips")


STORED_VOLUMES = VolumeOptions()
"""The options of the stored factors, and D_xcorr as printed."""
