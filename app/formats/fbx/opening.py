"""Opens an FBX file of any form, or says what is wrong with it."""

from __future__ import annotations

from app.errors import FormatNotSupported
from app.formats.common.failures import unreadable_byte
from app.formats.fbx.records import MAGIC, FbxFile
from app.formats.fbx.text import TextFile
from app.formats.fbx.tree import RecordFile
from app.kinedex_error import Place

MIN_VERSION, MAX_VERSION = 6000, 7999
_BIG_ENDIAN_AT = 22
_ZERO_AT = 20


def open_fbx(content: bytes) -> RecordFile:
    """The records of a file.

    Raises FormatNotSupported for big-endian files and for other versions, and Unreadable for files
    whose zero bytes were lost.
    """
    file = _opened(content)
    if not MIN_VERSION <= file.version <= MAX_VERSION:
        found = f"FBX {file.version / 1000:.1f}" if file.version else "FBX without a version"
        raise FormatNotSupported(
            f"This is {found}. Save it as FBX 7 (2011 or later).",
            places=[Place("FBXVersion", f"expected 6000 to 7999, found {file.version}")],
        )
    return file


def _opened(content: bytes) -> RecordFile:
    if not content.startswith(MAGIC[:18]):
        return TextFile(content)
    if len(content) < len(MAGIC) + 4:
        raise unreadable_byte(len(content), "expected the version, found the end of the file")
    if content[_ZERO_AT] != 0:
        raise unreadable_byte(
            _ZERO_AT,
            f"expected a zero byte, found {content[_ZERO_AT : _ZERO_AT + 1]!r}: the file is damaged"
            " (a version control system or an upload took it for text); take the original file",
        )
    if content[_BIG_ENDIAN_AT] == 1:
        version = int.from_bytes(content[len(MAGIC) : len(MAGIC) + 4], "big")
        raise FormatNotSupported(
            f"This is big-endian FBX {version / 1000:.1f}, which is not supported. Save it as FBX 7"
            " on another computer or with a newer program.",
            places=[Place(f"byte {_BIG_ENDIAN_AT}", "expected little-endian numbers (0), found 1")],
        )
    return FbxFile(content)
