"""What a clip can be exported as: names alone, so that `kinedex export --help` starts at once."""

from __future__ import annotations

from enum import StrEnum


class ExportFormat(StrEnum):
    """What a clip can be exported as."""

    BVH = "bvh"
    """Text, centimeters, Y up."""
    GLB = "glb"
    """Binary glTF 2.0 with a skinned body of sticks, meters, Y up."""
    NPZ = "npz"
    """NumPy arrays (see `app.formats.npz.reader`), meters, Y up."""
    CSV = "csv"
    """A row a frame: time, then x, y, z of each joint; seconds, meters, Y up."""


class ExportSkeleton(StrEnum):
    """On which body."""

    OWN = "own"
    """The clip's own joints."""
    CANONICAL = "canonical"
    """One body for all clips: 18 joints called by role, 1.7 m tall."""
