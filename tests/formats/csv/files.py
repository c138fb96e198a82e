"""CSV files as programs read them."""

from __future__ import annotations

import csv
import io
from pathlib import Path


def rows_of(file: Path) -> list[dict[str, str]]:
    """The rows of a file, by the names of its columns."""
    return list(csv.DictReader(io.StringIO(file.read_bytes().decode(), newline="")))
