"""The names of export formats. The module imports nothing slow, for `kinedex export --help`."""

from __future__ import annotations

from enum import StrEnum


class ExportFormat(StrEnum):
    """The format of an export."""

    BVH = "bvh"
    """Text, centimeters, Y up."""
    GLB = "glb"
    """Binary glTF 2.0 with a skinned body of sticks, meters, Y up."""
    NPZ = "npz"
    """NumPy arrays (see `app.formats.npz.reader`), meters, Y up."""
    CSV = "csv"
    """One row for each frame: time, then x, y, z of each joint; seconds, meters, Y up."""


class ExportSkeleton(StrEnum):
    """The skeleton of an export."""

    OWN = "own"
    """The clip's own joints."""
    CANONICAL = "canonical"
    """The same body for all clips: 18 joints named by role, 1.7 m tall."""
