"""What the README says works: its tasks run, and its commands, files and settings exist."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from app.config import SettingRow, settings_table
from tests.commands import blocks, commands_in, refusal
from tests.live import Live

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
OPERATORS = (ROOT / "docker" / "README.md").read_text()
ADDRESS = "http://127.0.0.1:8000"
"""Where the README expects the demo."""


def between(text: str, name: str) -> str:
    """The part of a document between two comments."""
    return text.partition(f"<!-- {name} -->")[2].partition(f"<!-- /{name} -->")[0]


def settings_markdown(rows: Sequence[SettingRow]) -> str:
    """The table of settings as operators see it; `python -m tests.test_readme` prints it."""
    lines = ["| setting | default | what it is |", "|---|---|---|"]
    for row in rows:
        default = f"`{row.default}`" if row.default else ""
        lines.append(f"| `{row.env}` | {default} | {row.description} |")
    return "\n".join(lines)


def test_the_table_of_settings_is_that_of_the_code() -> None:
    assert between(OPERATORS, "settings").strip() == settings_markdown(settings_table())


@pytest.mark.parametrize("words", commands_in(README) + commands_in(OPERATORS), ids=" ".join)
def test_every_command_exists(words: list[str]) -> None:
    assert refusal(words) is None


def test_unknown_commands_are_recognized() -> None:
    assert refusal(["serve", "--no-worker"]) is None
    assert refusal(["dance"]) is not None
    assert refusal(["serve", "--with-tea"]) is not None
    assert refusal(["evaluate", "tea"]) is not None


def test_every_make_target_exists() -> None:
    makefile = (ROOT / "Makefile").read_text()
    named = set(re.findall(r"(?:^|`)make ([a-z-]+)", README, re.MULTILINE))
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    assert {"demo", "test"} <= named <= targets


def _run(command: Sequence[str], service: Live, folder: Path) -> str:
    """What a program prints; it must succeed, and must not complain."""
    ended = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"KINEDEX_URL": service.url},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    return ended.stdout


def test_the_tasks_run_in_a_shell(demo_service: Live, tmp_path: Path) -> None:
    (tmp_path / ".venv").symlink_to(sys.prefix)
    script = "\n".join(blocks(between(README, "tasks"), "sh"))
    script = script.replace(ADDRESS, demo_service.url).replace("/tmp/", f"{tmp_path}/")
    strict = f'set -euo pipefail\ncurl() {{ command curl --fail --show-error "$@"; }}\n{script}'
    printed = _run(["bash", "-c", strict], demo_service, tmp_path)
    assert printed.count("kick") > 5
    assert printed.endswith("\n")
    assert '"person":{"label":"ada"' in printed
    written = {path.name for path in tmp_path.iterdir() if path.stat().st_size}
    assert written >= {"kick.glb", "angles.csv", "kick.bvh"}


def test_the_examples_in_python_run(demo_service: Live, tmp_path: Path) -> None:
    program = "\n".join(blocks(README, "python")).replace("/tmp/", f"{tmp_path}/")
    printed = _run([sys.executable, "-W", "error", "-c", program], demo_service, tmp_path)
    assert "by bruno" in printed
    assert "ada kick [" in printed
    assert "highest hand: " in printed
    assert printed.endswith("succeeded\n")
    assert (tmp_path / "kick.glb").read_bytes().startswith(b"glTF")


@pytest.mark.parametrize("page", ["README.md", "docker/README.md"])
def test_every_linked_file_and_section_exists(page: str) -> None:
    links = re.findall(r"\]\(([^)]+)\)", (ROOT / page).read_text())
    local = [link.partition("#") for link in links if "://" not in link]
    assert local
    for path, _, section in local:
        linked = (ROOT / page).parent / path
        assert linked.is_file(), path
        if section:
            titles = re.findall(r"^#+ (.*)$", linked.read_text(), re.MULTILINE)
            assert section in {title.lower().replace(" ", "-") for title in titles}


def test_the_readme_stays_short() -> None:
    assert len(README.splitlines()) <= 250


def test_every_path_on_the_architecture_page_exists() -> None:
    page = (ROOT / "app" / "README.md").read_text()
    paths = re.findall(r"`((?:\.\./)?[a-z_]+/[\w/]*(?:\.py)?|[a-z]+\.py)`", page)
    assert len(paths) > 40
    assert [path for path in paths if not (ROOT / "app" / path).exists()] == []


if __name__ == "__main__":
    print(settings_markdown(settings_table()))
