"""Finds the format of a file by its first bytes. The name of a file is never used.

Sources: C3D user manual (parameter block key 0x50 in the second byte), the FBX binary
header, NumPy's format specification, PKWARE's APPNOTE 4.3.7, Acclaim's ASF and AMC.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from app.errors import EmptyFile
from app.formats.npz.keys import is_known_array
from app.formats.unread import unread

HEAD_BYTES = 4096
"""The number of first bytes in which text formats are recognized."""
TAIL_BYTES = 64 * 2**10
"""The number of last bytes in which the directory of a ZIP archive is read."""
HEAD_LINES = 50
"""The most lines in which a keyword is searched. Comments may come before it."""

_MAGICS = (
    (b"Kaydara FBX Binary", "fbx"),
    (b"\x93NUMPY", "npy"),
    (b"glTF", "glb"),
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
    (re.compile(rb"\s*\"?Format Version\"?,", re.IGNORECASE), "csv"),
    (
        re.compile(
            rb"\s*\"?(Trajectories|Devices|Joints|Model Outputs|Segments)\"?[,;\t \"]*$",
            re.IGNORECASE,
        ),
        "csv",
    ),
    (re.compile(rb"\s*NO_OF_FRAMES\t"), "tsv"),
    (re.compile(rb"\s*\"?PathFileType\b", re.IGNORECASE), "trc"),
)
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_MVNX = re.compile(rb"<(\w+:)?mvnx[\s>]")
_JSON_START = re.compile(rb"[\[{]\s*([\[{\]}\"\d.-]|$)")
_GLTF_NAMES = (b'"asset"', b'"accessors"', b'"bufferViews"', b'"scenes"', b'"nodes"')
_KEYPOINTS = re.compile(
    rb'"[^"]{0,40}(keypoint|joint|landmark|people|instance|position|pose|frames)', re.IGNORECASE
)
_NESTED = re.compile(rb"\[\s*\[\s*[\[\d-]")
"""Lists of numbers in a list of frames."""
MIN_GLTF_NAMES = 2
"""The fewest parts of a glTF file that must be named near its ends."""
_C3D_KEY = 0x50
_ZIP_MAGICS = (b"PK\x03\x04", b"PK\x05\x06")
_ZIP_ENTRY = b"PK\x01\x02"


def sniff(content: bytes) -> str:
    """The format: one of READERS in `read.py`, or "zip".

    content: the whole file, or at least its first HEAD_BYTES and its last TAIL_BYTES. Raises
    EmptyFile if there is only white space, FormatNotSupported for other known formats, and
    UnknownFormat.
    """
    if not content or (len(content) <= HEAD_BYTES and not content.strip()):
        raise EmptyFile
    found = _binary(content) or _json(content) or _xml(content) or _text(content[:HEAD_BYTES])
    if found is None:
        raise unread(content[:HEAD_BYTES])
    return found


def _binary(content: bytes) -> str | None:
    for magic, name in _MAGICS:
        if content.startswith(magic):
            return name
    if is_zip(content):
        return "npz" if _is_npz(content) else "zip"
    # A C3D file is whole blocks of 512 bytes and begins with a small block number.
    if len(content) >= 512 and content[1] == _C3D_KEY and content[0] in range(1, 100):
        return "c3d"
    return None


def _xml(content: bytes) -> str | None:
    """The format of an XML file, which is that of Xsens."""
    head = content[:HEAD_BYTES].removeprefix(_BYTE_ORDER_MARK).lstrip()
    return "mvnx" if head.startswith(b"<") and _MVNX.search(head) else None


def _json(content: bytes) -> str | None:
    """The format of an object in JSON: glTF files name their parts near one of their ends."""
    head = content[:HEAD_BYTES].removeprefix(_BYTE_ORDER_MARK).lstrip()
    if not head.startswith((b"{", b"[")) or not _JSON_START.match(head):
        return None
    ends = head + content[-TAIL_BYTES:]
    if sum(name in ends for name in _GLTF_NAMES) >= MIN_GLTF_NAMES:
        return "gltf"
    return "json" if _KEYPOINTS.search(ends) or _NESTED.match(head) else None


def is_zip(head: bytes) -> bool:
    """Whether content that starts with `head` is a ZIP archive. NPZ files are ZIP archives."""
    return head.startswith(_ZIP_MAGICS)


def _is_npz(archive: bytes) -> bool:
    """Whether a ZIP archive is an NPZ file: it has only arrays, and one has a known name.

    Arrays alone are not enough, because an archive of NPY clips also has only arrays.
    """
    names = archive_names(archive)
    return all(name.endswith(".npy") for name in names) and any(
        is_known_array(name.removesuffix(".npy")) for name in names
    )


def archive_names(archive: bytes) -> list[str]:
    """The names of the entries of a ZIP archive that are listed in its last TAIL_BYTES."""
    return list(_entries(archive[-TAIL_BYTES:])) or [_first_entry(archive)]


def _entries(tail: bytes) -> Iterator[str]:
    """The names in the part of a ZIP directory (APPNOTE 4.3.12) that `tail` contains."""
    at = tail.find(_ZIP_ENTRY)
    while at >= 0:
        length = int.from_bytes(tail[at + 28 : at + 30], "little")
        yield tail[at + 46 : at + 46 + length].decode("latin-1")
        at = tail.find(_ZIP_ENTRY, at + 46 + length)


def _first_entry(content: bytes) -> str:
    """The name of the first entry. An archive that was cut off has no directory, only this."""
    length = int.from_bytes(content[26:28], "little")
    return content[30 : 30 + length].decode("latin-1")


def _text(head: bytes) -> str | None:
    head = head.removeprefix(_BYTE_ORDER_MARK)
    for line in head.splitlines()[:HEAD_LINES]:
        for keyword, name in _KEYWORDS:
            if keyword.match(line):
                return name
        if not _may_precede_keyword(line.strip()):
            return None
    return None


def _may_precede_keyword(line: bytes) -> bool:
    """Whether a keyword may follow: a comment, or the frame number of an AMC without header."""
    return not line or line.startswith((b"#", b";", b"//")) or line == b"1"
