"""Finds the format of a file by its first bytes. The name of a file is never used.

Sources: C3D user manual (parameter block key 0x50 in the second byte), the FBX binary
header, NumPy's format specification, PKWARE's APPNOTE 4.3.7, Acclaim's ASF and AMC.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from app.errors import EmptyFile, UnknownFormat
from app.formats.npz.keys import is_known

HEAD_BYTES = 4096
"""The first bytes, in which text formats are recognized."""
TAIL_BYTES = 64 * 2**10
"""The end of an archive, where its directory is: more than NPZ files need for theirs."""
HEAD_LINES = 50
"""Lines of the head in which a keyword may stand after comments."""

_MAGICS = (
    (b"Kaydara FBX Binary", "fbx"),
    (b"\x93NUMPY", "npy"),
)
_KEYWORDS = (
    (re.compile(rb"\s*HIERARCHY\b", re.IGNORECASE), "bvh"),
    (re.compile(rb"\s*:(version|name|units|bonedata|root)\b", re.IGNORECASE), "asf"),
    (
        re.compile(
            rb"\s*:(FULLY-SPECIFIED|DEGREES|RADIANS|SAMPLES-PER-SECOND|FRAME-RANGE|ASF-)",
            re.IGNORECASE,
        ),
        "amc",
    ),
    (re.compile(rb"\s*root(\s+[-+.\deE]+){1,6}\s*$"), "amc"),
    (re.compile(rb"\s*; FBX \d", re.IGNORECASE), "fbx"),
)
_C3D_KEY = 0x50
_ZIP_MAGICS = (b"PK\x03\x04", b"PK\x05\x06")
_ZIP_ENTRY = b"PK\x01\x02"


def sniff(content: bytes) -> str:
    """The format: "bvh", "amc", "asf", "c3d", "fbx", "npz", "npy" or "zip".

    content: all of it, or its first HEAD_BYTES and its last TAIL_BYTES at least. Raises
    EmptyFile where there is nothing but white space, UnknownFormat else.
    """
    if not content or (len(content) <= HEAD_BYTES and not content.strip()):
        raise EmptyFile
    return _binary(content) or _text(content[:HEAD_BYTES]) or _unknown(content)


def _binary(content: bytes) -> str | None:
    for magic, name in _MAGICS:
        if content.startswith(magic):
            return name
    if is_zip(content):
        return "npz" if _holds_arrays(content) else "zip"
    # A C3D file is whole blocks of 512 bytes and begins with a small block number.
    if len(content) >= 512 and content[1] == _C3D_KEY and content[0] in range(1, 100):
        return "c3d"
    return None


def is_zip(head: bytes) -> bool:
    """Whether content that begins so is a ZIP archive; an NPZ file is one, too."""
    return head.startswith(_ZIP_MAGICS)


def _holds_arrays(archive: bytes) -> bool:
    """Whether a ZIP is an NPZ file: arrays alone, and one at least by a name that we know.

    A ZIP of NPY clips holds arrays alone, too.
    """
    names = archive_names(archive)
    return all(name.endswith(".npy") for name in names) and any(
        is_known(name.removesuffix(".npy")) for name in names
    )


def archive_names(archive: bytes) -> list[str]:
    """The names of a ZIP's entries, as far as the end of its directory contains them."""
    return list(_entries(archive[-TAIL_BYTES:])) or [_first_entry(archive)]


def _entries(tail: bytes) -> Iterator[str]:
    """The names in a ZIP's directory (APPNOTE 4.3.12), as far as `tail` holds it."""
    at = tail.find(_ZIP_ENTRY)
    while at >= 0:
        length = int.from_bytes(tail[at + 28 : at + 30], "little")
        yield tail[at + 46 : at + 46 + length].decode("latin-1")
        at = tail.find(_ZIP_ENTRY, at + 46 + length)


def _first_entry(content: bytes) -> str:
    """The name of a ZIP's first entry: all there is of one that was cut off."""
    length = int.from_bytes(content[26:28], "little")
    return content[30 : 30 + length].decode("latin-1")


def _text(head: bytes) -> str | None:
    head = head.removeprefix(b"\xef\xbb\xbf")
    for line in head.splitlines()[:HEAD_LINES]:
        for keyword, name in _KEYWORDS:
            if keyword.match(line):
                return name
        if not _may_precede(line.strip()):
            return None
    return None


def _may_precede(line: bytes) -> bool:
    """Whether a keyword may follow: comments, and the frame number of an AMC without header."""
    return not line or line.startswith((b"#", b";", b"//")) or line == b"1"


def _unknown(content: bytes) -> str:
    shown = content[:16].decode("ascii", errors="backslashreplace")
    raise UnknownFormat(f"The content begins with {shown!r}, which no known format does")
