"""Sessions of browsers, which processes share."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from app.errors import StorageError
from app.store import sessions
from app.store.sessions import MAX_IDLE_SECONDS, Sessions
from app.store.shared_rows import FILE_NAME, open_engine
from app.store.store import Store

Open = Callable[[], Sessions]


@pytest.fixture
def now() -> list[float]:
    """The time; a test changes it."""
    return [1_000_000.0]


@pytest.fixture
def opened(store: Store, tmp_path: Path, now: list[float]) -> Iterator[Open]:
    """Opens the sessions of a library, as each of its processes does."""
    made = []

    def open_sessions() -> Sessions:
        made.append(Sessions(open_engine(store.database.engine, tmp_path), lambda: now[0]))
        return made[-1]

    yield open_sessions
    for one in made:
        one.close()


def test_each_process_knows_the_sessions_of_the_others(opened: Open) -> None:
    one, other = opened(), opened()
    token = one.begin("the key")
    assert other.key_of(token) == "the key"
    other.end(token)
    assert one.key_of(token) == ""
    assert one.key_of("") == one.key_of("nope") == ""


def test_sessions_end_after_a_time_without_a_call(opened: Open, now: list[float]) -> None:
    kept = opened()
    token = kept.begin("the key")
    for _ in range(2):
        now[0] += MAX_IDLE_SECONDS
        assert kept.key_of(token) == "the key"
    now[0] += MAX_IDLE_SECONDS + 1
    assert kept.key_of(token) == ""


def test_the_session_unused_for_longest_leaves_first(
    opened: Open, now: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sessions, "MAX_SESSIONS", 2)
    kept = opened()
    first, second = kept.begin("a"), kept.begin("b")
    now[0] += 100.0
    assert kept.key_of(first) == "a"
    now[0] += 100.0
    third = kept.begin("c")
    assert [kept.key_of(token) for token in (first, second, third)] == ["a", "", "c"]


@pytest.mark.sqlite_only
def test_no_token_is_stored(opened: Open, tmp_path: Path) -> None:
    token = opened().begin("the key")
    content = b"".join(path.read_bytes() for path in tmp_path.glob(f"{FILE_NAME}*"))
    assert b"the key" in content
    assert token.encode() not in content


@pytest.mark.sqlite_only
def test_rows_that_cannot_be_used_sign_nobody_in(opened: Open, tmp_path: Path) -> None:
    (tmp_path / FILE_NAME).write_bytes(b"no database" * 100)
    kept = opened()
    assert kept.key_of("token") == ""
    with pytest.raises(StorageError):
        kept.begin("the key")
