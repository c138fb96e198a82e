"""Failures of readers, with their place in the file."""

from __future__ import annotations

from app.errors import Place, Unreadable


def unreadable(line: int, message: str) -> Unreadable:
    """An Unreadable that names the line, counted from 1."""
    location = f"line {line}"
    return Unreadable(f"{location}: {message}", places=[Place(location, message)])
