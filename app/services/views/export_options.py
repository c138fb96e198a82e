"""What a client asks of an export, and which options go together."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

from app.motion.canonical.units import METERS_PER_UNIT
from app.services import fields
from app.services.views.clip_parts import Part
from app.services.views.export_format import (
    ExportContent,
    ExportFormat,
    ExportJoints,
    ExportSkeleton,
    ExportUnit,
)
from app.services.views.low_dimensional import Reduction

_Kind = TypeVar("_Kind", bound=StrEnum)
_F, _C = ExportFormat, ExportContent

USUAL_UNITS = {
    _F.BVH: ExportUnit.CM, _F.GLB: ExportUnit.M, _F.NPZ: ExportUnit.M, _F.CSV: ExportUnit.M,
    _F.C3D: ExportUnit.MM, _F.TRC: ExportUnit.MM,
}  # fmt: skip
"""The unit of each format if the client does not say one."""

_IN_METERS = (_F.GLB, _F.NPZ)
_OF_POSITIONS = (_F.NPZ, _F.CSV, _F.C3D, _F.TRC)


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Options that go together. fps: Hz, None for the clip's own rate. content: that of a CSV.

    part: only these seconds of the clip, None for all of it.
    """

    format: ExportFormat
    content: ExportContent
    unit: ExportUnit
    joints: ExportJoints
    skeleton: ExportSkeleton
    fps: float | None
    reduction: Reduction | None
    part: Part | None = None

    @property
    def units_per_meter(self) -> float:
        """By which meters are multiplied."""
        return 1.0 / METERS_PER_UNIT[self.unit]


def checked_options(
    format: ExportFormat | str,
    *,
    content: ExportContent | str | None = None,
    unit: ExportUnit | str | None = None,
    joints: ExportJoints | str = ExportJoints.ALL,
    skeleton: ExportSkeleton | str = ExportSkeleton.OWN,
    fps: float | None = None,
    reduction: Reduction | None = None,
    part: Part | None = None,
) -> ExportOptions:
    """The options of an export. Raises BadField for an unknown one, and for one that does not go
    with the format or the content."""
    file_format = _choice("format", ExportFormat, format)
    if content is not None and file_format is not _F.CSV:
        raise fields.bad_field("content", "goes with format=csv only")
    options = ExportOptions(
        format=file_format,
        content=_choice("content", ExportContent, content or _C.POSITIONS),
        unit=_choice("unit", ExportUnit, unit or USUAL_UNITS[file_format]),
        joints=_choice("joints", ExportJoints, joints),
        skeleton=_choice("skeleton", ExportSkeleton, skeleton),
        fps=fps,
        reduction=reduction,
        part=part,
    )
    _check_format(options)
    if options.content is not _C.POSITIONS:
        _check_table(options)
    if part is not None and (options.reduction or options.content is not _C.POSITIONS):
        raise fields.bad_field("part", "goes with positions and rotations of all dimensions only")
    return options


def _choice(field: str, kind: type[_Kind], value: str) -> _Kind:
    try:
        return kind(value)
    except ValueError:
        raise fields.bad_field(field, f"must be one of {', '.join(kind)}") from None


def _check_format(options: ExportOptions) -> None:
    if options.format in _IN_METERS and options.unit is not ExportUnit.M:
        raise fields.bad_field("unit", f"must be m with format={options.format}")
    if options.joints is ExportJoints.ROLES and options.format not in _OF_POSITIONS:
        known = ", ".join(_OF_POSITIONS)
        raise fields.bad_field("joints", f"must be all unless the format is one of {known}")


def _check_table(options: ExportOptions) -> None:
    """Tables of angles, segments and gait are of the clip as it was recorded, in meters."""
    condition = f"with content={options.content}"
    if options.unit is not ExportUnit.M:
        raise fields.bad_field("unit", f"must be m {condition}")
    if options.joints is not ExportJoints.ALL:
        raise fields.bad_field("joints", f"must be all {condition}")
    if options.skeleton is not ExportSkeleton.OWN:
        raise fields.bad_field("skeleton", f"must be own {condition}")
    if options.reduction is not None:
        raise fields.bad_field("dimensions", f"must be left out {condition}")
    if options.fps is not None and options.content is not _C.ANGLES:
        raise fields.bad_field(
            "fps", f"must be left out {condition}: it is not a table over frames"
        )
