"""The connection that is closed for a new one, compared with a slow and simple count."""

from __future__ import annotations

import resource
from collections import Counter

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from app.api.guard.connections import Connections, room_for_connections

MAX_OPEN, MAX_PER_ADDRESS = 5, 3
ADDRESSES = ["10.0.0.1", "10.0.0.2", "10.0.0.3"]


class Line:
    """A connection that only records whether it was closed."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.is_given_up = False

    def give_up(self) -> None:
        self.is_given_up = True


class Twin(RuleBasedStateMachine):
    """All events of connections, in any order. `waiting`: the longest waiting one first."""

    def __init__(self) -> None:
        super().__init__()
        self.counted = Connections(MAX_OPEN, MAX_PER_ADDRESS)
        self.waiting: list[Line] = []
        self.working: list[Line] = []

    @rule(address=st.sampled_from(ADDRESSES))
    def enter(self, address: str) -> None:
        line = Line(address)
        open_now = self.waiting + self.working
        full_of_one = sum(one.address == address for one in open_now) >= MAX_PER_ADDRESS
        victims = [one for one in self.waiting if not full_of_one or one.address == address]
        must_evict = full_of_one or len(open_now) >= MAX_OPEN
        entered = self.counted.enter(line, address)
        assert entered == (not must_evict or bool(victims))
        if entered and must_evict:
            assert victims[0].is_given_up
            self.waiting.remove(victims[0])
        if entered:
            self.waiting.append(line)

    @rule(index=st.integers(0, MAX_OPEN))
    def work(self, index: int) -> None:
        if self.waiting:
            line = self.waiting.pop(index % len(self.waiting))
            self.working.append(line)
            self.counted.works(line)

    @rule(index=st.integers(0, MAX_OPEN))
    def wait(self, index: int) -> None:
        if self.working:
            line = self.working.pop(index % len(self.working))
            self.waiting.append(line)
            self.counted.waits(line)

    @rule(index=st.integers(0, MAX_OPEN))
    def leave(self, index: int) -> None:
        open_now = self.waiting + self.working
        if open_now:
            line = open_now[index % len(open_now)]
            (self.waiting if line in self.waiting else self.working).remove(line)
            self.counted.leave(line)
            self.counted.leave(line)

    @invariant()
    def holds(self) -> None:
        open_now = self.waiting + self.working
        assert len(self.counted) == len(open_now) <= MAX_OPEN
        assert (
            max(Counter(line.address for line in open_now).values(), default=0) <= MAX_PER_ADDRESS
        )
        assert not any(line.is_given_up for line in open_now)


TestTwin = Twin.TestCase
TestTwin.settings = settings(max_examples=60, deadline=None, derandomize=True, database=None)


@pytest.mark.parametrize(
    ("one", "other", "are_one"),
    [
        ("2001:db8::1", "2001:db8::2", True),
        ("2001:db8::1", "2001:db8:0:1::1", False),
        ("::ffff:10.0.0.1", "10.0.0.1", True),
        ("10.0.0.1", "10.0.0.2", False),
        ("fe80::1%eth0", "fe80::2%eth0", True),
        ("", "", True),
    ],
)
def test_a_network_of_ipv6_counts_as_one_address(one: str, other: str, are_one: bool) -> None:
    counted, first = Connections(10, 1), Line(one)
    assert counted.enter(first, one)
    assert counted.enter(Line(other), other)
    assert first.is_given_up == are_one


def test_the_limit_of_files_bounds_the_connections(monkeypatch: pytest.MonkeyPatch) -> None:
    raised: list[tuple[int, int]] = []
    monkeypatch.setattr(resource, "getrlimit", lambda _: (256, 1024))
    monkeypatch.setattr(resource, "setrlimit", lambda _, limits: raised.append(limits))
    assert room_for_connections(100, backlog=256) == 100
    assert room_for_connections(10_000, backlog=256) == 512
    assert raised == [(1024, 1024)] * 2
