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
    """A table, by `ExportContent`."""
    C3D = "c3d"
    """The marker file of gait laboratories: a point is a joint; millimeters, Z up."""
    TRC = "trc"
    """The marker file of OpenSim: a marker is a joint; millimeters, Y up."""


class ExportContent(StrEnum):
    """The table of a CSV file."""

    POSITIONS = "positions"
    """A row a frame: time, then x, y, z of each joint; Y up."""
    ANGLES = "angles"
    """A row a frame: time, then the joint angles in degrees."""
    SEGMENTS = "segments"
    """A row a segment, from keypose to keypose."""
    GAIT = "gait"
    """A row a gait parameter: mean and standard deviation by side, and symmetry."""
    STRIDES = "strides"
    """A row a stride with its events and gait parameters."""
    CYCLES = "cycles"
    """A row a percent of the gait cycle, by side: mean and standard deviation of the angles."""


class ExportUnit(StrEnum):
    """The unit of lengths."""

    M = "m"
    CM = "cm"
    MM = "mm"
    IN = "in"
    FT = "ft"


class ExportJoints(StrEnum):
    """Which joints a file has, and how they are called."""

    ALL = "all"
    """All joints, by their names in the clip's file."""
    ROLES = "roles"
    """The joints of which the role is known, by role: the same names for all clips."""


class ExportSkeleton(StrEnum):
    """The skeleton of an export."""

    OWN = "own"
    """The clip's own joints."""
    CANONICAL = "canonical"
    """The same body for all clips: 18 joints named by role, 1.7 m tall."""
