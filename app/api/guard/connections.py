"""Limits on the open connections, in all and from one client address.

A connection waits while the client has not sent a whole request: its headers are incomplete, or
it is idle between two requests. If a limit is reached, the connection that has waited longest is
closed for the new one. So a client cannot lock others out by opening connections on which it sends
nothing or half a request. Others at the same address are not locked out either.

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
"""A provider gives each customer at least a network of this size, so it counts as one address."""
FILES_FOR_OTHERS = 256
"""File descriptors reserved for the database, uploaded files and child processes."""
QUIET_SECONDS = 10.0
"""Least time between two log lines about a reached limit."""


class Connection(Protocol):
    """A connection that can be counted and closed."""

    def give_up(self) -> None:
        """Close at once."""


class Connections:
    """The open connections of one server."""

    def __init__(self, limit: int, limit_per_address: int) -> None:
        self._limit, self._limit_per_address = limit, limit_per_address
        self._addresses: dict[Connection, str] = {}
        self._counts: dict[str, int] = {}
        # Ordered by waiting time, the longest first.
        self._waiting: OrderedDict[Connection, None] = OrderedDict()
        self._waiting_of: dict[str, OrderedDict[Connection, None]] = {}
        self._warned_at = float("-inf")

    def enter(self, connection: Connection, address: str) -> bool:
        """Count a new connection as waiting. Returns False if there is no room for it."""
        group = address_group(address)
        if self._counts.get(group, 0) >= self._limit_per_address:
            self._warn("client address", address)
            if not self._make_room(self._waiting_of.get(group)):
                return False
        if len(self._addresses) >= self._limit:
            self._warn("server", address)
            if not self._make_room(self._waiting):
                return False
        self._addresses[connection] = group
        self._counts[group] = self._counts.get(group, 0) + 1
        self.waits(connection)
        return True

    def waits(self, connection: Connection) -> None:
        """Note that the connection waits for its client's next request from now on."""
        group = self._addresses.get(connection)
        if group is not None:
            self._waiting[connection] = None
            self._waiting_of.setdefault(group, OrderedDict())[connection] = None

    def works(self, connection: Connection) -> None:
        """Note that the connection has a request to answer: it is not closed for another one."""
        group = self._addresses.get(connection)
        if group is not None:
            self._forget_waiting(connection, group)

    def leave(self, connection: Connection) -> None:
        """Stop counting a closed connection."""
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

    def _warn(self, limit: str, address: str) -> None:
        now = time.monotonic()
        if now - self._warned_at >= QUIET_SECONDS:
            self._warned_at = now
            log.warning("the %s has as many connections as the limit allows", limit)
            log.info("last connection came from %s", address)


def address_group(address: str) -> str:
    """The IPv4 address, or the network of the IPv6 address: both count as one address."""
    try:
        ip = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(ip, ipaddress.IPv4Address) or ip.is_loopback:
        return str(ip)
    if ip.ipv4_mapped is not None:
        return str(ip.ipv4_mapped)
    return str(ipaddress.ip_network((ip, IPV6_NETWORK_BITS), strict=False))


def room_for_connections(requested: int, backlog: int) -> int:
    """Return how many connections this process can hold, at most `requested`.

    Raises the process's limit of open files as far as needed and allowed.
    backlog: connections that can be accepted at once, before any of them is counted.
    """
    others = backlog + FILES_FOR_OTHERS
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    # Some systems report no limit but refuse to set RLIM_INFINITY, so set a number.
    files = requested + others if hard == resource.RLIM_INFINITY else hard
    if soft != resource.RLIM_INFINITY and soft < files:
        resource.setrlimit(resource.RLIMIT_NOFILE, (files, hard))
    room = max(1, min(requested, files - others))
    if room < requested:
        log.warning("%d connections at most: this process may open only %d files", room, files)
    return room
