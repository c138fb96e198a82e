"""Limits on how often a caller calls, and on how often it may try wrong keys.

A call with a valid key takes a token of the key, any other call one of the client's address. Health
checks take none, and neither do calls where no key is needed: they come from this machine.

A wrong key takes a token of its address and one of all addresses together. Without a token of the
address, nobody there can try any key, also no right one: else guesses would not be slower. If too
many addresses try wrong keys, those that have tried one lately must wait, and others need not. A
program that sends one and the same wrong key again and again is no guess: after some times it gets
429 and takes no token, so that it does not lock out other users of its address.
"""

from __future__ import annotations

import hashlib
import math

from app.api.failures.problems import RateLimited
from app.api.guard.callers import Caller, find_caller
from app.api.guard.connections import address_group
from app.config import Settings
from app.services.library.library import Library
from app.store.rates import Buckets, Level, Rate, open_buckets

FAILURES_OF_ADDRESS = Rate(per_minute=10, burst=20)
"""Wrong keys from one address."""
FAILURES_IN_ALL = Rate(per_minute=100, burst=500)
"""Wrong keys from all addresses."""
SAME_WRONG_KEY = Rate(per_minute=1, burst=10)
"""Uses of one and the same wrong key."""
ALL = "failures"
TOO_MANY_FAILURES = "Too many wrong API keys came from here; try again later."


class RateLimits:
    """The limits of one application."""

    def __init__(self, library: Library) -> None:
        settings: Settings = library.settings
        self._library = library
        self._buckets: Buckets = open_buckets(library.store.database.engine, settings.data_dir)
        per_minute = settings.rate_limit_per_minute
        self._rate = Rate(per_minute, settings.rate_limit_burst) if per_minute else None

    def identify(self, given: str, address: str | None) -> Caller:
        """Find the caller by a key; `given` is empty without one.

        Raises RateLimited after too many wrong keys, StorageError.
        """
        caller = find_caller(self._library, given, address)
        if caller.is_free or not given:
            return caller
        self._refuse_if_blocked(f"failures:{address_group(address or '')}")
        if caller.role is None:
            self._count_failure(given, address)
        return caller

    def take(self, caller: Caller) -> dict[str, str]:
        """Count a call; returns the headers that say what is left. Raises RateLimited."""
        if caller.is_free or self._rate is None:
            return {}
        name = f"key:{caller.key_id}"
        if caller.key_id is None:
            name = f"address:{address_group(caller.address or '')}"
        left = self._buckets.take(name, self._rate)
        if left is None:
            (level,) = self._buckets.look([name], [self._rate])
            raise RateLimited(retry_after=_seconds(level.wait_s), headers=self._headers(level))
        return self._headers(left)

    def close(self) -> None:
        """Close the connections."""
        self._buckets.close()

    def _headers(self, level: Level) -> dict[str, str]:
        """The fields of draft-ietf-httpapi-ratelimit-headers-10."""
        rate = self._rate
        if rate is None:
            return {}
        policy = f'"calls";q={rate.burst};w={math.ceil(rate.fill_s)}'
        waits = f";t={_seconds(level.wait_s)}" if level.wait_s else ""
        return {"RateLimit-Policy": policy, "RateLimit": f'"calls";r={level.tokens}{waits}'}

    def _refuse_if_blocked(self, name: str) -> None:
        own, all_others = self._buckets.look([name, ALL], [FAILURES_OF_ADDRESS, FAILURES_IN_ALL])
        if own.tokens == 0 or (all_others.tokens == 0 and not own.is_full):
            wait = max(own.wait_s, all_others.wait_s)
            raise RateLimited(TOO_MANY_FAILURES, retry_after=_seconds(wait))

    def _count_failure(self, given: str, address: str | None) -> None:
        digest = hashlib.sha256(given.encode("utf-8", "surrogatepass")).hexdigest()
        group = address_group(address or "")
        same = f"wrong:{group}:{digest[:32]}"
        if self._buckets.take(same, SAME_WRONG_KEY) is None:
            (level,) = self._buckets.look([same], [SAME_WRONG_KEY])
            raise RateLimited(TOO_MANY_FAILURES, retry_after=_seconds(level.wait_s))
        self._buckets.take(f"failures:{group}", FAILURES_OF_ADDRESS)
        self._buckets.take(ALL, FAILURES_IN_ALL)


def _seconds(wait_s: float) -> int:
    """Whole seconds of a header, at least one."""
    return max(1, math.ceil(wait_s))
