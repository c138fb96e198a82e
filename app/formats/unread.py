"""Formats that are known but not read, and how to convert them.

COLLADA is one of them: pycollada 0.9 reads the tree of nodes, but no animation channels.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from app.errors import FormatNotSupported, UnknownFormat
from app.kinedex_error import KinedexError, Place

READ = (
    "BVH, ASF with AMC, C3D, TRC, FBX, GLB, glTF, VRM, MVNX, NPZ, NPY, CSV of Motive or Nexus, TSV"
    " of Qualisys, JSON of 3-D keypoints"
)
"""The formats that are read, for messages."""


@dataclass(frozen=True, slots=True)
class _Unread:
    """A format by its first bytes, its name with an article, and what to do."""

    start: re.Pattern[bytes]
    name: str
    advice: str


def _begins(*starts: bytes) -> re.Pattern[bytes]:
    return re.compile(b"|".join(re.escape(start) for start in starts))


_BLENDER = "Open it in Blender and export BVH, FBX or GLB."
_UNREAD = (
    _Unread(
        re.compile(rb"\x80[\x02-\x05]|\(?(?:dp\d|lp\d|cnumpy)"),
        "a Python pickle, which could run code and is never opened",
        "Load it yourself and save its arrays by numpy.savez(path, positions=..., joint_names=...,"
        " frame_rate=...), or the poses of a body model as poses=..., trans=...,"
        " mocap_framerate=...",
    ),
    _Unread(
        re.compile(rb"%YAML[^\n]*\s+%TAG !u! tag:unity3d"),
        "a Unity asset or .anim file",
        "Export FBX from Unity (package FBX Exporter).",
    ),
    _Unread(_begins(b"UnityFS"), "a Unity bundle", "Export FBX from Unity (package FBX Exporter)."),
    _Unread(_begins(b"BLENDER"), "a Blender file", _BLENDER),
    _Unread(_begins(b"#usda", b"PXR-USDC"), "a USD file", f"Import it. {_BLENDER}"),
    _Unread(
        _begins(b"Vocaloid Motion Data", b"Vocaloid Pose Data"),
        "an MMD motion (VMD)",
        "Import it with its model into Blender (add-on MMD Tools) and export BVH or FBX.",
    ),
    _Unread(
        re.compile(rb"(?:<\?xml[^>]*>\s*(?:<!--.*?-->\s*)*)?<COLLADA", re.DOTALL),
        "a COLLADA file",
        "Import it into Blender up to 4.x and export FBX or GLB, or convert it by assimp: "
        "assimp export in.dae out.glb",
    ),
    _Unread(
        re.compile(rb"MATLAB 5\.0 MAT-file|MATLAB 7\.3"),
        "a MATLAB file",
        "Load it by scipy.io.loadmat and save its arrays by numpy.savez(path, positions=...,"
        " joint_names=..., frame_rate=...).",
    ),
    _Unread(
        _begins(b"\x89HDF\r\n"),
        "an HDF5 file",
        "Load it by h5py and save its arrays by numpy.savez(path, positions=...,"
        " joint_names=..., frame_rate=...).",
    ),
    _Unread(
        re.compile(rb"[^\n]{0,200}\n(?:[^\n]*\n){0,12}?[^\n]*endheader", re.IGNORECASE),
        "an OpenSim table of joint angles or forces (.mot, .sto)",
        "Send the TRC file of the markers.",
    ),
    _Unread(
        _begins(b"version https://git-lfs"),
        "a pointer of Git LFS, and not the file itself",
        "Get the file by `git lfs pull`.",
    ),
    _Unread(
        _begins(b"\x1f\x8b", b"7z\xbc\xaf", b"Rar!", b"BZh", b"\xfd7zXZ"),
        "a compressed archive",
        "Unpack it, or pack it as ZIP for an import.",
    ),
    _Unread(
        re.compile(rb"\s*\[Header\][\s\S]{0,400}?FileType\s+htr", re.IGNORECASE),
        "an HTR file",
        "Export BVH, FBX or TRC.",
    ),
    _Unread(re.compile(rb"\s*#VRML|ply\n|solid "), "a model that does not move", "Export FBX."),
)


def unread(head: bytes) -> KinedexError:
    """The error for a file that begins with `head` and is of no format that is read."""
    plain = head.removeprefix(b"\xef\xbb\xbf")
    found = next((one for one in _UNREAD if one.start.match(plain)), None)
    if found is not None:
        return FormatNotSupported(
            f"This is {found.name}. {found.advice} Formats that are read: {READ}.",
            places=[Place("file", f"expected another format, found {found.name}")],
        )
    shown = head[:16].decode("ascii", errors="backslashreplace")
    return UnknownFormat(
        f"The content begins with {shown!r}, but no known format does. Formats that are read:"
        f" {READ}.",
        places=[Place("file", f"expected a known format, found {shown!r}")],
    )
