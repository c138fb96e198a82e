"""Checks that the `kinedex` command lines in a document exist, without running them."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence

from typer.testing import CliRunner

from app.cli.main import program

_CONTINUED = re.compile(r"\\\n\s*")
_FENCED = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_INLINE = re.compile(r"`(kinedex\s[^`]+)`")


def code_lines(markdown: str) -> list[str]:
    """The lines of all code blocks. Continued lines are joined, comments removed."""
    blocks = [_CONTINUED.sub(" ", block) for _, block in _FENCED.findall(markdown)]
    lines = [line.partition(" #")[0].strip() for block in blocks for line in block.splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def blocks(markdown: str, language: str) -> list[str]:
    """The code blocks of a language."""
    return [block for found, block in _FENCED.findall(markdown) if found == language]


def commands_in(markdown: str) -> list[list[str]]:
    """The words after `kinedex` of every command, in code blocks and in running text."""
    found = [line for line in code_lines(markdown) if "kinedex" in line.split()[0]]
    found += [" ".join(text.split()) for text in _INLINE.findall(markdown)]
    return [shlex.split(line)[1:] for line in found]


def refusal(words: Sequence[str]) -> str | None:
    """The error of the command line for these words (after `kinedex`), or None if they are valid.

    `--help` is added, so that nothing runs; Typer checks commands and options before it.
    """
    answer = CliRunner().invoke(program, [*words, "--help"])
    return answer.output if answer.exit_code else None
