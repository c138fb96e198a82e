"""Any motion file: bytes in, Recording out, whatever the format."""

from __future__ import annotations

from collections.abc import Callable

from app.errors import FormatNotSupported, MotionNeeded, Place, SkeletonNotNeeded
from app.formats.amc import read_amc
from app.formats.bvh import read_bvh
from app.formats.c3d import read_c3d
from app.formats.fbx import read_fbx
from app.formats.npz import read_npy_positions, read_npz
from app.formats.sniff import sniff
from app.motion.recording import Recording


def read_lone_asf(content: bytes) -> Recording:  # noqa: ARG001
    """Raise MotionNeeded: an ASF file holds bones at rest."""
    raise MotionNeeded(places=[Place("file", "expected an AMC file, found an ASF file")])


READERS: dict[str, Callable[[bytes], Recording]] = {
    "amc": read_amc,
    "asf": read_lone_asf,
    "bvh": read_bvh,
    "c3d": read_c3d,
    "fbx": read_fbx,
    "npy": read_npy_positions,
    "npz": read_npz,
}
"""By the name that `sniff` gives."""


def read_recording(content: bytes, skeleton: bytes | None = None) -> Recording:
    """Read a motion file of a format found by its first bytes.

    skeleton: the ASF file that an AMC file needs. Raises EmptyFile, UnknownFormat,
    FormatNotSupported (known, but no reader yet), SkeletonNeeded, MotionNeeded,
    SkeletonNotNeeded, and what the reader raises: Unreadable with places, TooLarge.
    """
    name = sniff(content)
    if skeleton is not None and name not in ("amc", "asf"):
        places = [Place("skeleton", f"expected none with a {name.upper()} file")]
        raise SkeletonNotNeeded(places=places)
    if name == "amc":
        return read_amc(content, skeleton)
    reader = READERS.get(name)
    if reader is None:
        known = ", ".join(sorted(READERS))
        raise FormatNotSupported(
            f"This is a {name.upper()} file; this version reads {known.upper()} only"
        )
    return reader(content)
