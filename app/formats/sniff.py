"""What format some bytes are of, by their first bytes; a file's name is never asked.

Sources: C3D user manual (parameter block key 0x50 in the second byte), the FBX binary
header, NumPy's format specification, PKWARE's APPNOTE 4.3.7, Acclaim's ASF and AMC.
"""

from __future__ import annotations

import re

from app.errors import EmptyFile, UnknownFormat

HEAD_BYTES = 4096
"""The head that text formats are recognised in."""
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


def sniff(content: bytes) -> str:
    """The format: "bvh", "amc", "asf", "c3d", "fbx", "npz", "npy" or "zip".

    Raises EmptyFile where there is nothing but white space, UnknownFormat else.
    """
    if not content or (len(content) <= HEAD_BYTES and not content.strip()):
        raise EmptyFile
    return _binary(content) or _text(content[:HEAD_BYTES]) or _unknown(content)


def _binary(content: bytes) -> str | None:
    for magic, name in _MAGICS:
        if content.startswith(magic):
            return name
    if content.startswith((b"PK\x03\x04", b"PK\x05\x06")):
        return "npz" if _first_entry(content).endswith(b".npy") else "zip"
    # A C3D file is whole blocks of 512 bytes and begins with a small block number.
    if len(content) >= 512 and content[1] == _C3D_KEY and content[0] in range(1, 100):
        return "c3d"
    return None


def _first_entry(content: bytes) -> bytes:
    """The name of a ZIP's first entry."""
    length = int.from_bytes(content[26:28], "little")
    return content[30 : 30 + length]


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
