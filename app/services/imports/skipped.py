"""Files that an import skips: notes, pictures, tables and whatever else lies beside motions.

A file that no reader knows is skipped, unless its name says that it is a motion: then it failed.
"""

from __future__ import annotations

from posixpath import splitext

from app.errors import BadContent, EmptyFile, UnknownFormat
from app.kinedex_error import KinedexError

MOTION_ENDINGS = (".bvh", ".amc", ".c3d", ".fbx", ".npz", ".npy")
"""Endings of the names of motion files, in lower case."""


class NoMotion(BadContent):
    """The file is not a motion."""

    code = "no_motion"


def refuse_companion(path: str, format: str) -> None:
    """Raise NoMotion for a file that a reader knows but that cannot be a clip of its own."""
    if format == "asf":
        raise NoMotion("This skeleton goes with no AMC file of the import.")
    if format == "zip" and not is_called_motion(path):
        raise NoMotion("This is an archive inside of the import: import it on its own.")


def is_skipped(path: str, problem: KinedexError) -> bool:
    """Whether a file with this problem is skipped, and did not fail."""
    if isinstance(problem, NoMotion):
        return True
    return isinstance(problem, EmptyFile | UnknownFormat) and not is_called_motion(path)


def is_called_motion(path: str) -> bool:
    """Whether the name of a file is that of a motion."""
    return splitext(path)[1].lower() in MOTION_ENDINGS
