"""The operators' table of faults names tests that exist."""

from __future__ import annotations

import re
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]


def test_every_row_names_tests_that_exist() -> None:
    page = (TESTS.parent / "docker" / "README.md").read_text()
    table = page.partition("## What was tried")[2].partition("\n## ")[0]
    rows = [line for line in table.splitlines() if line.startswith("| ")][1:]
    assert len(rows) >= 15
    for row in rows:
        paths = re.findall(r"`([\w/]+\.py)`", row.rsplit("|", 2)[1])
        assert paths, row
        assert [path for path in paths if not (TESTS / path).is_file()] == []
