"""Token buckets that all processes of a library share: limits on how often something happens.

A bucket is one number (the generic cell rate algorithm, ITU-T I.371): the time at which it will be
full again. To take a token moves this time forward by the time that a token needs to come back. If
it would be farther away than the time in which an empty bucket fills, the bucket is empty. A time
that is farther away already is from before the clock was set back: that bucket counts as full.

The buckets are rows of one table (`shared_rows`). One statement takes a token, so that two
processes never take the same one. `limits` 5, the library for this, has no token bucket, and shares
its counters between processes only by a server such as Redis.

If the table cannot be used (the disk is full), calls are not limited, and the log says so.
"""

from __future__ import annotations

import logging
import sqlite3
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import TypeVar

from sqlalchemy import Connection, Engine, bindparam, text
from sqlalchemy.exc import DBAPIError

from app.store.shared_rows import make_table, open_engine

_log = logging.getLogger(__name__)
_Result = TypeVar("_Result")

PRUNE_INTERVAL_S = 60.0
"""Time between two removals of full buckets, which are the same as no buckets."""

_TABLE = "rate_buckets (name VARCHAR PRIMARY KEY, full_at DOUBLE PRECISION)"
_FROM = (
    "CASE WHEN rate_buckets.full_at > :now AND rate_buckets.full_at <= :horizon"
    " THEN rate_buckets.full_at ELSE :now END"
)
_TAKE = text(
    "INSERT INTO rate_buckets (name, full_at) VALUES (:name, :now + :cost)"  # noqa: S608
    f" ON CONFLICT (name) DO UPDATE SET full_at = {_FROM} + :cost"
    f" WHERE {_FROM} + :cost <= :horizon RETURNING full_at"
)
_LOOK = text("SELECT name, full_at FROM rate_buckets WHERE name IN :names").bindparams(
    bindparam("names", expanding=True)
)
_PRUNE = text("DELETE FROM rate_buckets WHERE full_at <= :now")


@dataclass(frozen=True, slots=True)
class Rate:
    """A limit: `burst` tokens at once, and `per_minute` in the long run."""

    per_minute: float
    burst: int

    @property
    def cost_s(self) -> float:
        """Seconds in which one token comes back."""
        return 60.0 / self.per_minute

    @property
    def fill_s(self) -> float:
        """Seconds in which an empty bucket fills."""
        return self.burst * self.cost_s


@dataclass(frozen=True, slots=True)
class Level:
    """How full a bucket is. tokens: whole ones; wait_s: seconds until there is one."""

    tokens: int
    wait_s: float
    is_full: bool = False


class Buckets:
    """The buckets of a library; threads may share it. clock: seconds, the same in all processes."""

    def __init__(self, engine: Engine, clock: Callable[[], float] = time.time) -> None:
        self._engine = engine
        self._clock = clock
        self._lock = Lock()
        self._is_made = False
        self._pruned_at = self._warned_at = float("-inf")

    def take(self, name: str, rate: Rate) -> Level | None:
        """Take a token; returns what is left, or None if there was no token to take."""
        now = self._clock()
        horizon = now + rate.fill_s + _TINY_S
        values = {"name": name, "now": now, "cost": rate.cost_s, "horizon": horizon}

        def take(connection: Connection) -> Level | None:
            full_at = connection.execute(_TAKE, values).scalar_one_or_none()
            return None if full_at is None else _level(full_at, now, rate)

        unlimited: Level | None = Level(rate.burst, 0.0)
        return self._execute(take, now, unlimited)

    def look(self, names: Collection[str], rates: Collection[Rate]) -> list[Level]:
        """How full buckets are, without taking a token."""
        now = self._clock()

        def look(connection: Connection) -> dict[str, float]:
            rows = connection.execute(_LOOK, {"names": [*names]})
            return {row.name: row.full_at for row in rows}

        nothing: dict[str, float] = {}
        found = self._execute(look, now, nothing)
        return [
            _level(found.get(name, now), now, rate) for name, rate in zip(names, rates, strict=True)
        ]

    def close(self) -> None:
        """Close the connections."""
        self._engine.dispose()

    def _execute(
        self, work: Callable[[Connection], _Result], now: float, otherwise: _Result
    ) -> _Result:
        """Do the work with a connection; `otherwise` is its result if the table fails."""
        try:
            self._prepare(now)
            with self._engine.connect() as connection:
                return work(connection)
        except (DBAPIError, sqlite3.Error) as problem:
            if time.monotonic() - self._warned_at >= PRUNE_INTERVAL_S:
                self._warned_at = time.monotonic()
                _log.warning("calls are not limited: the table of limits fails (%s)", problem)
            return otherwise

    def _prepare(self, now: float) -> None:
        """Make the table at first, and remove full buckets from time to time."""
        with self._lock:
            is_due = time.monotonic() - self._pruned_at >= PRUNE_INTERVAL_S
            if self._is_made and not is_due:
                return
            with self._engine.connect() as connection:
                if not self._is_made:
                    make_table(connection, _TABLE)
                connection.execute(_PRUNE, {"now": now})
            self._is_made, self._pruned_at = True, time.monotonic()


_TINY_S = 1e-6
"""Rounding of times since 1970 must not refuse the last token."""


def open_buckets(library: Engine, folder: Path) -> Buckets:
    """The buckets of the library with this database; folder: for the file, with SQLite."""
    return Buckets(open_engine(library, folder))


def _level(full_at: float, now: float, rate: Rate) -> Level:
    missing_s = full_at - now
    if not 0.0 < missing_s <= rate.fill_s + _TINY_S:  # full, or the clock was set back
        return Level(rate.burst, 0.0, is_full=True)
    tokens = int((rate.fill_s - missing_s) / rate.cost_s + _TINY_S)
    wait_s = 0.0 if tokens else missing_s + rate.cost_s - rate.fill_s
    return Level(tokens, wait_s)
