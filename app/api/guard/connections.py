"""How many connections are open, in all and from one client address; and who makes room.

A connection waits while the client has not sent a whole request: its headers are incomplete, or
it is idle between two requests. Where a limit is reached, the connection that has waited longest
is given up for the new one. So a client that opens connections and sends nothing, or half of a
request, shuts nobody out, not even its own address.

Used by one event loop only, so there is no lock.
"""

from __future__ import annotations

import ipaddress
import logging
import resource
import time
from collections import OrderedDict
from typing import Protocol

log = logging.getLogger(__name__)

IPV6_NETWORK_BITS = 64
"""One customer gets at least so large a network of IPv6 addresses: it counts as one address."""
FILES_FOR_OTHERS = 256
"""File descriptors kept free for the database, uploaded files and child processes."""
QUIET_SECONDS = 10.0
"""Between two log lines about a limit that is reached."""


class Connection(Protocol):
    """What is counted here."""

    def give_up(self) -> None:
        """Close at once."""


class Connections:
    """The open connections of one server."""

    def __init__(self, most: int, most_per_address: int) -> None:
        self.most, self.most_per_address = most, most_per_address
        self._addresses: dict[Connection, str] = {}
        self._counts: dict[str, int] = {}
        # In order of the time since when they wait, the longest first.
        self._waiting: OrderedDict[Connection, None] = OrderedDict()
        self._waiting_of: dict[str, OrderedDict[Connection, None]] = {}
        self._told_at = float("-inf")

    def enter(self, connection: Connection, address: str) -> bool:
        """Count a new connection, which waits; False where there is no room for it."""
        group = _group(address)
        if self._counts.get(group, 0) >= self.most_per_address:
            self._tell("client address", address)
            if not self._make_room(self._waiting_of.get(group)):
                return False
        if len(self._addresses) >= self.most:
            self._tell("server", address)
            if not self._make_room(self._waiting):
                return False
        self._addresses[connection] = group
        self._counts[group] = self._counts.get(group, 0) + 1
        self.waits(connection)
        return True

    def waits(self, connection: Connection) -> None:
        """The connection waits from now on for its client's next request."""
        group = self._addresses.get(connection)
        if group is not None:
            self._waiting[connection] = None
            self._waiting_of.setdefault(group, OrderedDict())[connection] = None

    def works(self, connection: Connection) -> None:
        """The connection has a request to answer: it is not given up."""
        group = self._addresses.get(connection)
        if group is not None:
            self._forget_waiting(connection, group)

    def leave(self, connection: Connection) -> None:
        """The connection is closed."""
        group = self._addresses.pop(connection, None)
        if group is None:
            return
        self._forget_waiting(connection, group)
        self._counts[group] -= 1
        if not self._counts[group]:
            del self._counts[group]

    def __len__(self) -> int:
        return len(self._addresses)

    def _make_room(self, waiting: OrderedDict[Connection, None] | None) -> bool:
        if not waiting:
            return False
        longest = next(iter(waiting))
        self.leave(longest)
        longest.give_up()
        return True

    def _forget_waiting(self, connection: Connection, group: str) -> None:
        self._waiting.pop(connection, None)
        waiting = self._waiting_of.get(group)
        if waiting is not None:
            waiting.pop(connection, None)
            if not waiting:
                del self._waiting_of[group]

    def _tell(self, limit: str, address: str) -> None:
        now = time.monotonic()
        if now - self._told_at >= QUIET_SECONDS:
            self._told_at = now
            log.warning("the %s has as many connections as the limit allows", limit)
            log.info("last connection came from %s", address)


def _group(address: str) -> str:
    """What counts as one address: an IPv4 address, or a network of IPv6 addresses."""
    try:
        found = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address) or found.is_loopback:
        return str(found)
    if found.ipv4_mapped is not None:
        return str(found.ipv4_mapped)
    return str(ipaddress.ip_network((found, IPV6_NETWORK_BITS), strict=False))


def room_for_connections(wanted: int, backlog: int) -> int:
    """How many connections this process can hold, at most `wanted`; raises its limit of files.

    backlog: connections that are accepted at once, before any of them is counted.
    """
    others = backlog + FILES_FOR_OTHERS
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    # Some systems name no limit, and yet refuse to set none.
    files = wanted + others if hard == resource.RLIM_INFINITY else hard
    if soft != resource.RLIM_INFINITY and soft < files:
        resource.setrlimit(resource.RLIMIT_NOFILE, (files, hard))
    room = max(1, min(wanted, files - others))
    if room < wanted:
        log.warning("%d connections at most: this process may open only %d files", room, files)
    return room
