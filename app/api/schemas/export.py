"""How a clip is exported as a file."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Fps
from app.api.schemas.low_dimensional import ReductionFields
from app.services.views.export_format import ExportFormat, ExportSkeleton


class ExportQuery(ReductionFields):
    """Format, frame rate, skeleton and number of dimensions of an exported clip."""

    format: ExportFormat = Field(
        description="BVH (centimeters), or GLB (glTF 2.0), NPZ (NumPy), CSV (all in meters)."
    )
    fps: Fps | None = Field(
        None, description="The motion is resampled to this rate. Default: the clip's own rate."
    )
    skeleton: ExportSkeleton = Field(
        ExportSkeleton.OWN,
        description="own: the joints of the clip. canonical: one skeleton of 18 joints for "
        "all clips.",
    )
