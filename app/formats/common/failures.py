"""Errors of readers, with their place in the file."""

from __future__ import annotations

from app.errors import Place, TooLarge, Unreadable


def unreadable(line: int, message: str) -> Unreadable:
    """An Unreadable with the line, counted from 1."""
    location = f"line {line}"
    return Unreadable(f"{location}: {message}", places=[Place(location, message)])


def unreadable_at(offset: int, message: str) -> Unreadable:
    """An Unreadable of a binary file with the byte, counted from 0."""
    location = f"byte {offset}"
    return Unreadable(f"{location}: {message}", places=[Place(location, message)])


def too_large(location: str, message: str) -> TooLarge:
    """A TooLarge with its place: a line, a byte, or what is counted."""
    return TooLarge(f"{location}: {message}", places=[Place(location, message)])
