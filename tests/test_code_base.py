"""The code base itself: its layout, the sizes of modules, and text that must not be committed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ALLOWED_FOLDERS = {"app", "migrations", "tests", "docker"}
MAX_MODULE_LINES = 350
MACHINE_PATH = re.compile(r"/(?:work|farm|root)/[A-Za-z.]")
DOWNLOAD_ADDRESS = re.compile(
    r'"resolved"\s*:|^registry\s*=\s|\{ registry\b'
    r"|^--(?:extra-)?index-url|^[^#\s]+ @ (?:https?|file):",
    re.MULTILINE,
)


def _tracked() -> list[Path]:
    listing = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listing.returncode:
        pytest.skip("not a git checkout: there is no list of the committed files")
    return [ROOT / line for line in listing.stdout.splitlines() if (ROOT / line).is_file()]


def test_only_the_agreed_folders_are_at_the_top() -> None:
    top = {path.relative_to(ROOT).parts[0] for path in _tracked() if path.parent != ROOT}
    assert {name for name in top if not name.startswith(".")} <= ALLOWED_FOLDERS


def test_no_module_is_too_long() -> None:
    long = {
        str(path.relative_to(ROOT)): lines
        for path in _tracked()
        if path.suffix == ".py" and (lines := len(path.read_text().splitlines())) > MAX_MODULE_LINES
    }
    assert not long


def _text_files() -> list[Path]:
    return [
        path
        for path in _tracked()
        if path.suffix not in {".png", ".ico"} and path != Path(__file__).resolve()
    ]


@pytest.mark.parametrize("pattern", [MACHINE_PATH, DOWNLOAD_ADDRESS], ids=["path", "address"])
def test_nothing_of_a_machine_is_committed(pattern: re.Pattern[str]) -> None:
    found = [
        str(path.relative_to(ROOT))
        for path in _text_files()
        if pattern.search(path.read_text(errors="replace"))
    ]
    assert not found


def test_every_module_has_a_docstring() -> None:
    silent = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "app").rglob("*.py")
        if not path.read_text().lstrip().startswith('"""')
    ]
    assert not silent


def test_no_pickle_no_eval_no_shell() -> None:
    forbidden = re.compile(r"\bimport pickle\b|\bpickle\.loads?\(|\beval\(|\bexec\(|shell=True")
    found = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "app").rglob("*.py")
        if forbidden.search(path.read_text())
    ]
    assert not found


def test_only_the_api_names_parts_of_a_request() -> None:
    located = re.compile(r"""["'](?:body|query|path|header)\.""")
    found = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "app").rglob("*.py")
        if "api" not in path.relative_to(ROOT).parts and located.search(path.read_text())
    ]
    assert not found
