"""JSON objects of answers as flat rows, for data frames and CSV."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from kinedex.errors import PackageNeeded

if TYPE_CHECKING:
    import pandas as pd


def flat(document: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """An object as one row: members of inner objects get names like `clip.name`.

    Lists of texts are joined by spaces; other lists stay as they are.
    """
    row: dict[str, Any] = {}
    for name, one in document.items():
        if isinstance(one, dict):
            row |= flat(one, f"{prefix}{name}.")
        elif isinstance(one, list) and all(isinstance(part, str) for part in one):
            row[prefix + name] = " ".join(one)
        else:
            row[prefix + name] = one
    return row


def table(documents: Iterable[Mapping[str, Any]]) -> tuple[list[str], list[dict[str, Any]]]:
    """The columns and rows of a table of objects. A column exists if any object has it."""
    rows = [flat(document) for document in documents]
    return list(dict.fromkeys(name for row in rows for name in row)), rows


def dataframe(documents: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """A table with one row for each object. Raises PackageNeeded.

    Times (columns that end with `_at`) become times in UTC.
    """
    try:
        import pandas as pd
    except ImportError:
        raise PackageNeeded("pandas", "A data frame") from None
    columns, rows = table(documents)
    frame = pd.DataFrame(rows, columns=columns)
    for name in columns:
        if name.endswith("_at"):
            frame[name] = pd.to_datetime(frame[name], utc=True, format="ISO8601")
    return frame
