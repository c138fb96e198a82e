"""How a clip is exported as a file."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Fps
from app.api.schemas.low_dimensional import ReductionFields
from app.services.views.export_format import (
    ExportContent,
    ExportFormat,
    ExportJoints,
    ExportSkeleton,
    ExportUnit,
)


class ExportQuery(ReductionFields):
    """Format, frame rate, skeleton and number of dimensions of an exported clip."""

    format: ExportFormat = Field(
        description="BVH, GLB (glTF 2.0), NPZ (NumPy), CSV, C3D or TRC (OpenSim)."
    )
    content: ExportContent | None = Field(
        None, description="The table of a CSV file, with format=csv only; default: positions."
    )
    unit: ExportUnit | None = Field(
        None,
        description="Of lengths; default: cm for BVH, mm for C3D and TRC, m for the others. GLB, "
        "NPZ and tables other than positions are in m only.",
    )
    joints: ExportJoints = Field(
        ExportJoints.ALL,
        description="All joints by their own names, or those with a role, by role: with NPZ, C3D, "
        "TRC and CSV positions.",
    )
    fps: Fps | None = Field(
        None,
        description="Resampled by time; default: the clip's own rate. Not with tables of segments "
        "and gait.",
    )
    skeleton: ExportSkeleton = Field(
        ExportSkeleton.OWN,
        description="own: the joints of the clip. canonical: one skeleton of 18 joints for "
        "all clips.",
    )
