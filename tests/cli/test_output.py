"""What is printed for people: others' names as they are, and nothing that a terminal obeys."""

from __future__ import annotations

import pytest

from app.cli.output import print_table


@pytest.mark.parametrize("name", ["[red]walk[/red].bvh", "root:x:0", "[/]", "日本", "a\\b"])
def test_names_are_shown_as_they_are(capsys: pytest.CaptureFixture[str], name: str) -> None:
    print_table(("name", "score"), [(name, 0.5), (None, 1.0)])
    printed = capsys.readouterr().out
    assert name in printed
    assert "0.500" in printed


def test_control_characters_do_not_reach_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    print_table(("name",), [("a\x1b]0;title\x07\x1b[31m\rb",)])
    printed = capsys.readouterr().out
    assert not set(printed) & {"\x1b", "\x07", "\r"}
    assert "title" in printed
