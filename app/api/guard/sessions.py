"""Who is signed in with a browser: a random token in a cookie stands for an API key.

The key itself never reaches the cookie: browsers send a cookie to every port of a machine. The
sessions are in this process's memory. Who is signed in signs in again after a restart.
"""

from __future__ import annotations

import secrets
import time
from collections import OrderedDict
from collections.abc import Callable
from threading import Lock

COOKIE = "kinedex_session"
MAX_SESSIONS = 1000
"""Then the session that was not used for the longest time ends."""
MAX_IDLE_SECONDS = 12 * 3600.0
TOKEN_BYTES = 32


class Sessions:
    """API keys by the tokens of their sessions; may be used by many threads.

    clock: seconds that never go back.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = Lock()
        self._open: OrderedDict[str, tuple[str, float]] = OrderedDict()

    def begin(self, key: str) -> str:
        """A new token for a key that was checked."""
        token = secrets.token_urlsafe(TOKEN_BYTES)
        with self._lock:
            self._open[token] = (key, self._clock())
            if len(self._open) > MAX_SESSIONS:
                self._open.popitem(last=False)
        return token

    def key_of(self, token: str) -> str:
        """The key of a session, which may have been revoked since; empty if there is none."""
        with self._lock:
            key, used_at = self._open.pop(token, ("", 0.0))
            now = self._clock()
            if not key or now - used_at > MAX_IDLE_SECONDS:
                return ""
            self._open[token] = (key, now)
            return key

    def end(self, token: str) -> None:
        """The token stands for nothing from now on."""
        with self._lock:
            self._open.pop(token, None)
