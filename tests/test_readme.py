"""The settings, commands, API calls and files that the README names exist."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from app.config import SettingRow, settings_table
from tests.commands import code_lines, commands_in, refusal
from tests.live import Live

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
BEGIN, END = "<!-- settings -->", "<!-- /settings -->"
_CURL_PATH = re.compile(r"\$B(/[\w/.$-]*)")
_METHOD = re.compile(r"-X (\w+)")


def settings_markdown(rows: Sequence[SettingRow]) -> str:
    """The table of settings as the README shows it; `python -m tests.test_readme` prints it."""
    lines = ["| setting | default | what it is |", "|---|---|---|"]
    for row in rows:
        default = f"`{row.default}`" if row.default else ""
        lines.append(f"| `{row.env}` | {default} | {row.description} |")
    return "\n".join(lines)


def test_the_table_of_settings_is_that_of_the_code() -> None:
    shown = README.partition(BEGIN)[2].partition(END)[0].strip()
    assert shown == settings_markdown(settings_table())


@pytest.mark.parametrize("words", commands_in(README), ids=" ".join)
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


def test_every_call_of_the_tour_is_described(idle_service: Live) -> None:
    with idle_service.client() as client:
        described = client.get("/openapi.json").json()["paths"]
    calls = [call for line in code_lines(README) for call in _calls(line)]
    assert len(calls) > 15
    unknown = [call for call in calls if not _is_described(described, *call)]
    assert not unknown


def test_the_example_in_python_runs(demo_service: Live) -> None:
    (example,) = re.findall(r"^```python\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
    ended = subprocess.run(
        [sys.executable, "-W", "error", "-c", example],
        env=os.environ | {"KINEDEX_URL": demo_service.url},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "by bruno" in ended.stdout
    assert "highest hand: " in ended.stdout
    assert "100%" in ended.stdout


def test_every_linked_file_exists() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", README)
    local = [link for link in links if "://" not in link]
    assert local
    assert [link for link in local if not (ROOT / link).is_file()] == []


def test_every_path_on_the_architecture_page_exists() -> None:
    page = (ROOT / "app" / "README.md").read_text()
    paths = re.findall(r"`((?:\.\./)?[a-z_]+/[\w/]*(?:\.py)?|[a-z]+\.py)`", page)
    assert len(paths) > 40
    assert [path for path in paths if not (ROOT / "app" / path).exists()] == []


def _calls(line: str) -> list[tuple[str, str]]:
    """(method, path) of each curl command in a line."""
    found = []
    for command in line.split("curl")[1:]:
        method = _METHOD.search(command)
        sends = "--json" in command or " -F " in command
        verb = method.group(1) if method else "POST" if sends else "GET"
        found += [(verb, path) for path in _CURL_PATH.findall(command)]
    return found


def _is_described(described: dict[str, Any], method: str, path: str) -> bool:
    return any(
        re.fullmatch(re.sub(r"\{\w+\}", "[^/]+", template), path) and method.lower() in calls
        for template, calls in described.items()
    )


if __name__ == "__main__":
    print(settings_markdown(settings_table()))
