"""The code base itself: layout, sizes, and what must never be committed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ALLOWED_FOLDERS = {"app", "migrations", "tests", "docker"}
LONGEST_MODULE = 350
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
        pytest.skip("not a git checkout: the layout cannot be judged")
    return [ROOT / line for line in listing.stdout.splitlines() if (ROOT / line).is_file()]


def test_only_the_agreed_folders_stand_at_the_top() -> None:
    top = {path.relative_to(ROOT).parts[0] for path in _tracked() if path.parent != ROOT}
    assert {name for name in top if not name.startswith(".")} <= ALLOWED_FOLDERS


def test_no_module_outgrows_one_noun() -> None:
    long = {
        str(path.relative_to(ROOT)): lines
        for path in _tracked()
        if path.suffix == ".py" and (lines := len(path.read_text().splitlines())) > LONGEST_MODULE
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


def test_every_package_of_the_core_says_what_it_is_for() -> None:
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


def test_only_the_api_says_which_part_of_a_request_a_field_stands_in() -> None:
    located = re.compile(r"""["'](?:body|query|path|header)\.""")
    found = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "app").rglob("*.py")
        if "api" not in path.relative_to(ROOT).parts and located.search(path.read_text())
    ]
    assert not found
