"""Times and durations as options of commands have them."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta

import typer

TIME_HELP = "a time (2027-01-31, 2027-01-31T12:00Z), or an age (90d, 12h, 30m)."
LIFE_HELP = "a duration (90d, 12h, 30m) or a time (2027-01-31, 2027-01-31T12:00Z)."
_DURATION = re.compile(r"(?P<count>[0-9]{1,6})(?P<unit>[dhm])", re.ASCII)
_UNITS = {"d": timedelta(days=1), "h": timedelta(hours=1), "m": timedelta(minutes=1)}


def time_before(text: str, option: str) -> datetime:
    """A time, or the time that was so long ago. Raises BadParameter."""
    return _time(text, option, -1)


def time_after(text: str, option: str) -> datetime:
    """A time, or the time that will be after so long. Raises BadParameter."""
    return _time(text, option, 1)


def _time(text: str, option: str, sign: int) -> datetime:
    match = _DURATION.fullmatch(text)
    try:
        if match is not None:
            return datetime.now(UTC) + sign * int(match["count"]) * _UNITS[match["unit"]]
        time = datetime.fromisoformat(text)
        return time.replace(tzinfo=UTC) if time.tzinfo is None else time.astimezone(UTC)
    except (ValueError, OverflowError) as problem:
        raise typer.BadParameter(f"{text!r} is neither {TIME_HELP}", param_hint=option) from problem
