"""JSON objects of answers as flat rows, for data frames and CSV."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
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
    pd = _pandas()
    columns, rows = table(documents)
    frame = pd.DataFrame(rows, columns=columns)
    for name in columns:
        if name.endswith("_at"):
            frame[name] = pd.to_datetime(frame[name], utc=True, format="ISO8601")
    return frame


def read_tables(path: str | PathLike[str]) -> dict[str, pd.DataFrame]:
    """The tables of an evaluation by name, from the file of `kinedex evaluate ... --csv FILE`.

    A table has the columns in which any of its rows has a value. Raises PackageNeeded.
    """
    whole = _pandas().read_csv(path)
    return {
        str(name): rows.drop(columns="table").dropna(axis=1, how="all").convert_dtypes()
        for name, rows in whole.groupby("table", sort=False)
    }


def _pandas() -> Any:
    try:
        import pandas as pd
    except ImportError:
        raise PackageNeeded("pandas", "A data frame") from None
    return pd
