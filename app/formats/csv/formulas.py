"""Cells of CSV that a spreadsheet would take for a formula get an apostrophe before them.

A name such as `=HYPERLINK(...)` could else send a table's content away when somebody opens it.
Such texts begin with `=`, `+`, `-`, `@`, a tab or a carriage return (OWASP, *CSV Injection*). A
text that begins with apostrophes and then one of these gets one more, so that `unguarded` finds
every text again. Numbers are not guarded, also negative ones.
"""

from __future__ import annotations

import re

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
_GUARDED = re.compile(r"'+[=+\-@\t\r]")


def guarded(text: str) -> str:
    """The text as a cell that no spreadsheet takes for a formula."""
    return f"'{text}" if _FORMULA.match(text) else text


def unguarded(cell: str) -> str:
    """The text of a cell; the reverse of `guarded`."""
    return cell[1:] if _GUARDED.match(cell) else cell
