"""The errors of the readers. Each names the position in the file."""

from __future__ import annotations

from app.errors import TooLarge, Unreadable
from app.kinedex_error import Place


def unreadable_at(location: str, message: str) -> Unreadable:
    """An Unreadable with a location: a key, a frame, a joint, or a node of the file."""
    return Unreadable(f"{location}: {message}", places=[Place(location, message)])


def unreadable_line(line: int, message: str) -> Unreadable:
    """An Unreadable of a text file with the line, counted from 1."""
    return unreadable_at(f"line {line}", message)


def unreadable_byte(offset: int, message: str) -> Unreadable:
    """An Unreadable of a binary file with the byte, counted from 0."""
    return unreadable_at(f"byte {offset}", message)


def too_large(location: str, message: str) -> TooLarge:
    """A TooLarge with its location: a line, a byte, or the quantity that is too large."""
    return TooLarge(f"{location}: {message}", places=[Place(location, message)])
