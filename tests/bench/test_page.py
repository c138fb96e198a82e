"""The page of figures: a bench replaces its own section, and every bench has one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.bench.page import PAGE, Section

FOLDER = Path(__file__).parent
BENCHES = sorted(
    path.stem.removeprefix("test_")
    for path in FOLDER.glob("test_*.py")
    if path != Path(__file__).resolve()
)


@pytest.fixture
def page(tmp_path: Path) -> Path:
    path = tmp_path / "README.md"
    path.write_text(
        "# Figures\n\n<!-- a -->\nold a\n<!-- /a -->\n\n<!-- b -->\nold b\n<!-- /b -->\n"
    )
    return path


def test_a_section_replaces_what_its_last_run_printed(
    page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    section = Section("a", "How fast", trials="ten", chance="half")
    section.print("\nspeed", 3, end="")
    section.print("!  ")
    section.write(page)
    assert capsys.readouterr().out == "\nspeed 3!  \n"
    text = page.read_text()
    assert "old a" not in text
    assert "old b" in text
    for part in ("## How fast", "Trials: ten", "Chance: half", "test_a.py", "\nspeed 3!\n"):
        assert part in text
    section.write(page)
    assert page.read_text() == text


def test_a_new_section_is_added(page: Path) -> None:
    section = Section("c", "How good", trials="two")
    section.print("figure")
    section.write(page)
    assert page.read_text().rstrip().endswith("<!-- /c -->")
    assert "Chance" not in page.read_text()


@pytest.mark.parametrize("name", BENCHES)
def test_every_bench_has_its_section(name: str) -> None:
    assert re.search(rf"<!-- {name} -->\n## .*?<!-- /{name} -->", PAGE.read_text(), re.DOTALL)
    source = (FOLDER / f"test_{name}.py").read_text()
    assert re.search(rf'FIGURES = Section\(\s*"{name}",', source)
    assert re.findall(r"(?<!FIGURES\.)\bprint\(", source) == []
