"""Asks the public lists of vulnerabilities about all packages: `make audit`.

    python -m tests.supply.audit PIP_AUDIT NPM_COMMAND...

pip-audit asks about the packages of `docker/requirements.txt`, npm about those of the pages.
Without a network there is no answer: that is said, and is no failure. The exit code is 1 if a
vulnerability is known.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.supply.licenses import REQUIREMENTS, ROOT

TIMEOUT_S = 120
WEB = ROOT / "app" / "web"


@dataclass(frozen=True, slots=True)
class Answer:
    """What a list of vulnerabilities knows. asked: packages with an answer; found: sentences."""

    asked: int
    found: tuple[str, ...] = ()


NO_ANSWER = Answer(0)


def from_pip_audit(output: str) -> Answer:
    """The answer in the JSON of pip-audit. A package that was skipped has no answer."""
    document = _parsed(output)
    if document is None:
        return NO_ANSWER
    answered = [one for one in document.get("dependencies", []) if "vulns" in one]
    found = [
        f"{one['name']} {one['version']}: {vulnerability['id']}, fixed in "
        f"{', '.join(vulnerability.get('fix_versions', [])) or 'no version'}"
        for one in answered
        for vulnerability in one["vulns"]
    ]
    return Answer(len(answered), tuple(found))


def from_npm_audit(output: str) -> Answer:
    """The answer in the JSON of `npm audit`. Without a network, it has an error instead."""
    document = _parsed(output)
    if document is None or "vulnerabilities" not in document:
        return NO_ANSWER
    found = [
        f"{name}: {one.get('severity')}, in {one.get('range')}"
        for name, one in document["vulnerabilities"].items()
    ]
    total = document.get("metadata", {}).get("dependencies", {}).get("total", 1)
    return Answer(total, tuple(found))


def _parsed(output: str) -> dict[str, Any] | None:
    try:
        document = json.loads(output)
    except ValueError:
        return None
    return document if isinstance(document, dict) else None


def _output(command: Sequence[str], folder: Path) -> str:
    try:
        ended = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return ended.stdout


def main(pip_audit: str, npm: Sequence[str]) -> int:
    """Ask both lists; see the module."""
    python = [pip_audit, "--requirement", str(REQUIREMENTS), "--disable-pip", "--format", "json"]
    pages = [*npm, "audit", "--omit=dev", "--json"]
    answers = {
        "Python packages": from_pip_audit(_output(python, ROOT)),
        "packages of the pages": from_npm_audit(_output(pages, WEB)),
    }
    for name, answer in answers.items():
        if not answer.asked:
            sys.stdout.write(f"audit: {name}: NOT ASKED, the list cannot be reached\n")
            continue
        sys.stdout.write(f"audit: {name}: {answer.asked} asked, {len(answer.found)} vulnerable\n")
        for sentence in answer.found:
            sys.stdout.write(f"  {sentence}\n")
    return 1 if any(answer.found for answer in answers.values()) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
