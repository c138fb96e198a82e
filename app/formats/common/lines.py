"""The lines of text formats, with their numbers. The whole text is never copied into lines."""

from __future__ import annotations

from collections.abc import Iterator

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def with_plain_newlines(content: bytes) -> bytes:
    """`content` with lines ended by a line feed and without a byte order mark."""
    text = content.removeprefix(_BYTE_ORDER_MARK)
    if b"\r" in text:
        text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return text


def filled_lines(text: bytes, first_line: int = 1) -> Iterator[tuple[int, bytes]]:
    """The number and the content of each line that is not blank; `text` has plain newlines."""
    start, number = 0, first_line
    while start < len(text):
        end = text.find(b"\n", start)
        end = len(text) if end < 0 else end
        line = text[start:end]
        if line and not line.isspace():
            yield number, line
        start, number = end + 1, number + 1
