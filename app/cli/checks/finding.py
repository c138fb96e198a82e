"""What a check of `kinedex doctor` found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path


class Level(StrEnum):
    """How bad a finding is."""

    OK = "ok"
    NOTE = "note"
    """It works, but something may surprise the user."""
    PROBLEM = "problem"
    """Something does not work."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding. advice: what to do, empty if nothing is to be done."""

    check: str
    level: Level
    found: str
    advice: str = ""


@dataclass(frozen=True, slots=True)
class Care:
    """How thorough `kinedex doctor` is.

    is_quick: do not read the contents of files and arrays; mends: mend what is damaged; backup:
    where whole files may be.
    """

    is_quick: bool = False
    mends: bool = False
    backup: Path | None = None


def fine(check: str, found: str) -> Finding:
    """A finding without a problem."""
    return Finding(check, Level.OK, found)


def note(check: str, found: str, advice: str = "") -> Finding:
    """A finding that the user should know."""
    return Finding(check, Level.NOTE, found, advice)


def problem(check: str, found: str, advice: str) -> Finding:
    """A problem, with what to do about it."""
    return Finding(check, Level.PROBLEM, found, advice)
