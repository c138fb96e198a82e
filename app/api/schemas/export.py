"""How a clip is exported as a file."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Fps
from app.api.schemas.low_dimensional import ReductionFields
from app.services.views.export_format import ExportFormat, ExportSkeleton


class ExportQuery(ReductionFields):
    """Format, frame rate and body of an exported clip, and from how many dimensions it is drawn."""

    format: ExportFormat = Field(
        description="BVH (centimetres), GLB (glTF 2.0), NPZ (NumPy) or CSV; metres but for BVH."
    )
    fps: Fps | None = Field(None, description="Resampled by time; default: the clip's own rate.")
    skeleton: ExportSkeleton = Field(
        ExportSkeleton.OWN,
        description="The clip's own joints, or one body of 18 joints that all clips play on.",
    )
