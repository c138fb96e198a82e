"""Token buckets: never more calls than the limit, in all processes together."""

from __future__ import annotations

import multiprocessing
import sqlite3
import stat
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import create_engine

from app.store.rates import Buckets, Level, Rate, open_buckets
from app.store.shared_rows import FILE_NAME

SQLITE = create_engine("sqlite:///unused")
RATE = Rate(per_minute=60, burst=5)


class Clock:
    def __init__(self) -> None:
        self.now = 1_800_000_000.0

    def __call__(self) -> float:
        return self.now


def _buckets(folder: Path, clock: Clock | None = None) -> Buckets:
    opened = open_buckets(SQLITE, folder)
    if clock is not None:
        opened._clock = clock
    return opened


class SlowBucket:
    """A token bucket as a textbook has it: tokens that grow with time."""

    def __init__(self, rate: Rate, now: float) -> None:
        self.rate, self.tokens, self.at = rate, float(rate.burst), now

    def take(self, now: float) -> bool:
        grown = self.tokens + (now - self.at) * self.rate.per_minute / 60.0
        self.tokens, self.at = min(grown, float(self.rate.burst)), now
        if self.tokens < 1.0 - 1e-5:
            return False
        self.tokens -= 1.0
        return True


@given(
    pauses=st.lists(st.integers(0, 40).map(lambda n: n / 8), min_size=1, max_size=60),
    burst=st.integers(1, 6),
    per_minute=st.sampled_from([30.0, 60.0, 240.0]),
)
def test_it_allows_what_a_textbook_bucket_allows(
    tmp_path_factory: pytest.TempPathFactory, pauses: list[float], burst: int, per_minute: float
) -> None:
    clock, rate = Clock(), Rate(per_minute, burst)
    buckets = _buckets(tmp_path_factory.mktemp("rates"), clock)
    slow = SlowBucket(rate, clock.now)
    for pause in pauses:
        clock.now += pause
        assert (buckets.take("a", rate) is not None) == slow.take(clock.now)
    buckets.close()


def test_a_level_says_what_is_left_and_when_there_is_more(tmp_path: Path) -> None:
    clock = Clock()
    buckets = _buckets(tmp_path, clock)
    assert buckets.look(["a"], [RATE]) == [Level(5, 0.0, is_full=True)]
    left = [buckets.take("a", RATE) for _ in range(6)]
    assert [level and level.tokens for level in left] == [4, 3, 2, 1, 0, None]
    (level,) = buckets.look(["a"], [RATE])
    assert (level.tokens, level.is_full) == (0, False)
    assert level.wait_s == pytest.approx(1.0, abs=1e-3)
    assert buckets.take("b", RATE) is not None
    clock.now += level.wait_s
    assert buckets.take("a", RATE) is not None
    buckets.close()


@pytest.mark.parametrize("jump", [-3600.0, 3600.0])
def test_a_jump_of_the_clock_locks_nobody_out(tmp_path: Path, jump: float) -> None:
    clock = Clock()
    buckets = _buckets(tmp_path, clock)
    while buckets.take("a", RATE) is not None:
        pass
    clock.now += jump
    assert buckets.look(["a"], [RATE])[0].tokens == RATE.burst
    assert [buckets.take("a", RATE) is not None for _ in range(6)] == [True] * 5 + [False]
    buckets.close()


def test_processes_share_the_tokens(tmp_path: Path) -> None:
    rate = Rate(per_minute=0.001, burst=100)
    context = multiprocessing.get_context("spawn")
    with context.Pool(3) as pool:
        taken = pool.starmap(_take_all, [(tmp_path, rate)] * 3)
    assert sum(taken) == 100


def _take_all(folder: Path, rate: Rate) -> int:
    buckets = _buckets(folder)
    taken = sum(buckets.take("shared", rate) is not None for _ in range(60))
    buckets.close()
    return taken


def test_full_buckets_are_removed_and_the_file_is_private(tmp_path: Path) -> None:
    clock = Clock()
    for number in range(2):
        buckets = _buckets(tmp_path, clock)
        buckets.take(f"address:{number}", RATE)
        buckets.close()
        clock.now += 100.0
    with sqlite3.connect(tmp_path / FILE_NAME) as connection:
        names = connection.execute("SELECT name FROM rate_buckets").fetchall()
    assert names == [("address:1",)]
    assert stat.S_IMODE((tmp_path / FILE_NAME).stat().st_mode) == 0o600


def test_if_the_table_fails_nobody_is_limited(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / FILE_NAME).write_bytes(b"this is no database" * 100)
    buckets = _buckets(tmp_path)
    for _ in range(10):
        assert buckets.take("a", RATE) is not None
    assert buckets.look(["a"], [RATE])[0].tokens == RATE.burst
    assert len([line for line in caplog.messages if "not limited" in line]) == 1
    buckets.close()
