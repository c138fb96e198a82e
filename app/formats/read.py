"""Any motion file: bytes in, Recording out, whatever the format."""

from __future__ import annotations

from collections.abc import Callable

from app.errors import FormatNotSupported
from app.formats.bvh import read_bvh
from app.formats.npz import read_npy_positions, read_npz
from app.formats.sniff import sniff
from app.motion.recording import Recording

READERS: dict[str, Callable[[bytes], Recording]] = {
    "bvh": read_bvh,
    "npy": read_npy_positions,
    "npz": read_npz,
}
"""By the name that `sniff` gives."""


def read_recording(content: bytes) -> Recording:
    """Read a motion file of a format found by its first bytes.

    Raises EmptyFile, UnknownFormat, FormatNotSupported (known, but no reader yet),
    and what the reader raises: Unreadable with places, TooLarge.
    """
    name = sniff(content)
    reader = READERS.get(name)
    if reader is None:
        known = ", ".join(sorted(READERS))
        raise FormatNotSupported(
            f"This is a {name.upper()} file; this version reads {known.upper()} only"
        )
    return reader(content)
