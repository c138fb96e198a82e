"""Answers of the lists of vulnerabilities are told from no answer."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.supply import audit
from tests.supply.audit import NO_ANSWER, Answer, from_npm_audit, from_pip_audit


def test_answers_of_pip_audit() -> None:
    whole = {"name": "a", "version": "1", "vulns": []}
    bad = {"name": "b", "version": "2", "vulns": [{"id": "CVE-1", "fix_versions": ["3"]}]}
    skipped = {"name": "c", "skip_reason": "Dependency not found"}
    found = from_pip_audit(json.dumps({"dependencies": [whole, bad, skipped]}))
    assert found == Answer(2, ("b 2: CVE-1, fixed in 3",))
    assert from_pip_audit(json.dumps({"dependencies": [skipped]})) == NO_ANSWER


def test_answers_of_npm_audit() -> None:
    vulnerable = {"vulnerabilities": {"a": {"severity": "high", "range": "<2"}}}
    assert from_npm_audit(json.dumps(vulnerable)) == Answer(1, ("a: high, in <2",))
    assert from_npm_audit(json.dumps({"message": "405 Method Not Allowed"})) == NO_ANSWER


@pytest.mark.parametrize("output", ["", "no JSON", "[]"])
def test_other_output_is_no_answer(output: str) -> None:
    assert from_pip_audit(output) == from_npm_audit(output) == NO_ANSWER


@pytest.mark.parametrize(("vulnerable", "code"), [(True, 1), (False, 0)])
def test_the_exit_code(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    vulnerable: bool,
    code: int,
) -> None:
    found = {"a": {"severity": "high"}} if vulnerable else {}

    def output(command: list[str], folder: Path) -> str:
        return json.dumps({"vulnerabilities": found}) if "audit" in command else ""

    monkeypatch.setattr(audit, "_output", output)
    assert audit.main("pip-audit", ["npm"]) == code
    printed = capsys.readouterr().out
    assert "Python packages: NOT ASKED" in printed
    assert f"{int(vulnerable)} vulnerable" in printed
