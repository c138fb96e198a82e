"""Output for people: names are unchanged, and control characters never reach the terminal."""

from __future__ import annotations

import pytest

from app.cli import output
from app.cli.output import MAX_WIDTH, print_table, print_text


@pytest.mark.parametrize("name", ["[red]walk[/red].bvh", "root:x:0", "[/]", "日本", "a\\b"])
def test_names_are_printed_unchanged(capsys: pytest.CaptureFixture[str], name: str) -> None:
    print_table(("name", "score"), [(name, 0.5), (None, 1.0)])
    printed = capsys.readouterr().out
    assert name in printed
    assert "0.500" in printed


@pytest.mark.parametrize(
    ("number", "shown"),
    [(3e-13, "<0.001"), (0.000499, "<0.001"), (0.0005, "0.001"), (0.0, "0.000"), (-0.1, "-0.100")],
)
def test_small_numbers_do_not_look_like_zero(
    capsys: pytest.CaptureFixture[str], number: float, shown: str
) -> None:
    print_table(("score",), [(number,)])
    assert capsys.readouterr().out.split() == ["score", shown]


def test_control_characters_do_not_reach_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    print_table(("name",), [("a\x1b]0;title\x07\x1b[31m\rb",)])
    printed = capsys.readouterr().out
    assert not set(printed) & {"\x1b", "\x07", "\r"}
    assert "title" in printed


def test_long_text_is_wrapped_between_words(capsys: pytest.CaptureFixture[str]) -> None:
    print_text("\nshort\n" + "walk-left\x07 " * 40)
    empty, short, *long = capsys.readouterr().out.splitlines()
    assert (empty, short) == ("", "short")
    assert len(long) > 1
    assert max(map(len, long)) <= MAX_WIDTH
    assert set(" ".join(long).split()) == {"walk-left\N{REPLACEMENT CHARACTER}"}


@pytest.mark.parametrize(
    ("width", "name", "path", "title"),
    [
        (100, "001", "lab/anna/001.bvh", "lab/anna/001.bvh"),
        (80, "001", "lab/anna/001.bvh", "…/anna/001.bvh"),
        (100, "001", f"{'x' * 40}/001.bvh", f"…{'x' * 27}/001.bvh"),
        (100, "high kick", "lab/anna/001.bvh", "high kick"),
        (100, "001", None, "001"),
    ],
)
def test_the_title_of_a_clip_tells_files_with_one_name_apart(
    monkeypatch: pytest.MonkeyPatch, width: int, name: str, path: str | None, title: str
) -> None:
    monkeypatch.setattr(output.console, "width", width)
    assert output.clip_title(name, path) == title


def test_wrapped_cells_are_complete(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(output.console, "width", 30)
    detail = "revoked_key_id: 0123456789abcdef0123456789abcdef"
    output.print_table(("by", "details"), [("-", detail)])
    lines = capsys.readouterr().out.splitlines()[1:]
    assert "".join(line[4:] for line in lines).replace(" ", "") == detail.replace(" ", "")
