"""Reads a motion file of any format: bytes in, Recording out."""

from __future__ import annotations

from collections.abc import Callable

from app.errors import BadField, FormatNotSupported, MotionNeeded, SkeletonNotNeeded
from app.formats.acclaim.amc import read_amc
from app.formats.bvh.reader import read_bvh
from app.formats.c3d.reader import read_c3d
from app.formats.fbx.reader import read_fbx
from app.formats.gltf.reader import read_gltf
from app.formats.keypoints.reader import read_keypoints
from app.formats.mvnx.reader import read_mvnx
from app.formats.npz.reader import read_npy_positions, read_npz
from app.formats.single_pose import with_held_pose
from app.formats.sniff import archive_names, sniff
from app.formats.tables.reader import read_csv, read_tsv
from app.formats.trc.reader import read_trc
from app.kinedex_error import Place
from app.motion.skeleton.recording import Recording


def read_lone_asf(content: bytes) -> Recording:  # noqa: ARG001
    """Raise MotionNeeded, because an ASF file contains only the skeleton."""
    raise MotionNeeded(places=[Place("file", "expected an AMC file, found an ASF file")])


READERS: dict[str, Callable[[bytes], Recording]] = {
    "amc": read_amc,
    "asf": read_lone_asf,
    "bvh": read_bvh,
    "c3d": read_c3d,
    "csv": read_csv,
    "fbx": read_fbx,
    "glb": read_gltf,
    "gltf": read_gltf,
    "json": read_keypoints,
    "mvnx": read_mvnx,
    "npy": read_npy_positions,
    "npz": read_npz,
    "trc": read_trc,
    "tsv": read_tsv,
}
"""The reader of each format, by the name that `sniff` returns."""


WITH_STACKS: dict[str, Callable[[bytes, str | None], Recording]] = {
    "fbx": read_fbx,
    "glb": read_gltf,
    "gltf": read_gltf,
}
"""The readers of the formats whose files may have several animations."""


def read_recording(
    content: bytes, skeleton: bytes | None = None, stack: str | None = None
) -> Recording:
    """Read a motion file. Its first bytes decide its format. A single frame becomes a held pose.

    skeleton: the ASF file that an AMC file needs. stack: the name of an animation of an FBX or
    glTF file; by default the longest one. Raises EmptyFile, UnknownFormat, FormatNotSupported (for
    example, for a ZIP archive without a clip), SkeletonNeeded, MotionNeeded, SkeletonNotNeeded,
    BadField for a stack that does not exist, Unreadable with places, and TooLarge.
    """
    return with_held_pose(_read(content, skeleton, stack))


def _read(content: bytes, skeleton: bytes | None, stack: str | None) -> Recording:
    name = sniff(content)
    if skeleton is not None and name not in ("amc", "asf"):
        places = [Place("skeleton", f"expected none with a {name.upper()} file")]
        raise SkeletonNotNeeded(places=places)
    if stack is not None:
        check_stack_belongs(name)
    if name == "amc":
        return read_amc(content, skeleton)
    if name in WITH_STACKS:
        return WITH_STACKS[name](content, stack)
    reader = READERS.get(name)
    if reader is None:
        raise _no_clip(content)
    return reader(content)


def _no_clip(archive: bytes) -> FormatNotSupported:
    """The error for a ZIP archive that does not have the arrays of a clip."""
    found = ", ".join(name[:60] for name in archive_names(archive)[:10])
    message = f"expected an array of positions, or of SMPL poses; found {found}"
    return FormatNotSupported(
        "This ZIP archive is not an NPZ file of motion. Import it if it contains motion files.",
        places=[Place("positions", message)],
    )


def check_stack_belongs(format: str) -> None:
    """Raise BadField if files of this format do not have animation stacks."""
    if format not in WITH_STACKS:
        message = f"goes with an FBX or glTF file, not with {format.upper()}"
        raise BadField(f"stack: {message}", places=[Place("stack", message)])
