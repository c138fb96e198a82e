"""Reads C3D files of labeled markers: bytes in, Recording out.

We have our own reader because ezc3d 1.7 crashes, hangs or needs gigabytes for one broken file in
twenty, and reads a truncated file as one frame. The tests compare our reader with ezc3d.
"""

from __future__ import annotations

from app.formats.c3d.points import Points, read_points
from app.formats.common.units import named_unit
from app.formats.markers.recording import recording_of_markers
from app.formats.markers.tracks import Tracks
from app.motion.skeleton.recording import Recording

_OUTPUTS = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS")
"""The parameters that list the results of gait models."""


def read_c3d(content: bytes) -> Recording:
    """Read a C3D file.

    Units and axes are those of the file. Raises Unreadable with the byte; Unreadable with the
    marker and its frames if a marker that a joint needs is hidden for too long; and TooLarge.
    """
    points = read_points(content)
    tracks = Tracks(
        labels=points.labels,
        positions=points.positions,
        first_frame=points.first_frame,
        frame_rate=points.frame_rate,
        up_axis=_up_axis(points),
        metres_per_unit=_metres_per_unit(points),
        cautions=points.cautions,
        outputs=_model_outputs(points),
    )
    return recording_of_markers(tracks, "c3d")


def _model_outputs(points: Points) -> frozenset[str]:
    found = (points.parameters.get(f"POINT:{group}") for group in _OUTPUTS)
    return frozenset(label for group in found if group is not None for label in group.texts)


def _metres_per_unit(points: Points) -> float | None:
    units = points.parameters.get("POINT:UNITS")
    return named_unit(units.texts[0]) if units is not None and units.texts else None


def _up_axis(points: Points) -> str:
    """The axis that points up on a screen; Z, which is usual, if the file does not give it."""
    screen = points.parameters.get("POINT:Y_SCREEN")
    axis = screen.texts[0].strip().lower()[-1:] if screen is not None and screen.texts else ""
    return axis if axis in ("x", "y", "z") and axis else "z"
