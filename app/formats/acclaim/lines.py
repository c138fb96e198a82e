"""The lines of ASF and AMC files: words without comments.

Source: M. Schafer, "Acclaim skeleton file definition v1.10" (1994). A comment begins with #. Some
files also use //.
"""

from __future__ import annotations

from collections.abc import Iterator

from app.formats.common.lines import filled_lines


def lines_of_words(text: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """The number and the words of each line that has words; `text` has plain newlines."""
    for number, line in filled_lines(text):
        if b"#" in line or b"//" in line:
            line = line.partition(b"#")[0].partition(b"//")[0]
        words = line.split()
        if words:
            yield number, words
