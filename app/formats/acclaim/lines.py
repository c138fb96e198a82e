"""What ASF and AMC files share: lines of words, comments, keywords that begin with a colon.

Source: M. Schafer, "Acclaim skeleton file definition v1.10" (1994). Comments begin with #,
in the wild also with //.
"""

from __future__ import annotations

from collections.abc import Iterator

from app.formats.common.lines import filled_lines


def worded_lines(text: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Number and words of each line that holds any; `text` has plain newlines."""
    for number, line in filled_lines(text):
        if b"#" in line or b"//" in line:
            line = line.partition(b"#")[0].partition(b"//")[0]
        words = line.split()
        if words:
            yield number, words
