"""Calls with a key: one effect each, also if the process is killed at any moment."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from datetime import UTC, datetime, timedelta

import pytest

from app.errors import AnswerLost, CallInProgress, CallOvertaken
from app.store import keyed_calls, keys
from app.store.jobs import owners
from app.store.key_role import KeyRole
from app.store.keyed_calls import KEPT, Answer, Try
from app.store.store import Store

ANSWER = Answer("f" * 64, 201, "application/json", b"{}")
NOW = datetime(2026, 1, 2, tzinfo=UTC)
ME = owners.new_owner("api")


def begin(
    store: Store,
    key: str = "k",
    *,
    can_repeat: bool = False,
    now: datetime = NOW,
    is_gone: Callable[[str], bool] = owners.is_gone,
) -> Try | Answer:
    with store.write() as tx:
        return keyed_calls.begin(tx, key, ME, can_repeat=can_repeat, now=now, is_gone=is_gone)


def begun(store: Store, **options: bool) -> Try:
    started = begin(store, is_gone=lambda _: True, **options)
    assert isinstance(started, Try)
    return started


def change(store: Store) -> None:
    with store.write() as tx:
        keys.create(tx, KeyRole.READ, "made by the call")


def changes(store: Store) -> int:
    with store.read() as tx:
        return len(keys.list_keys(tx))


def finish(store: Store, this: Try) -> None:
    with store.write() as tx:
        keyed_calls.finish(tx, this, ANSWER)


def test_a_repeated_call_gets_the_answer_for_a_day(store: Store) -> None:
    this = begun(store)
    with keyed_calls.running(this):
        change(store)
    finish(store, this)
    assert begin(store) == ANSWER
    assert begin(store, now=NOW + KEPT) == ANSWER
    assert isinstance(begin(store, "other"), Try)
    assert isinstance(begin(store, now=NOW + KEPT + timedelta(seconds=1)), Try)


def test_a_call_that_runs_is_not_begun_again(store: Store) -> None:
    begun(store)
    with pytest.raises(CallInProgress):
        begin(store)


def test_a_call_that_changed_nothing_can_be_made_again(store: Store) -> None:
    this = begun(store)
    with store.write() as tx:
        keyed_calls.give_up(tx, this)
    assert isinstance(begin(store), Try)


def test_a_call_that_changed_something_is_given_up_only_if_it_can_be_repeated(store: Store) -> None:
    this = begun(store)
    with keyed_calls.running(this):
        change(store)
    with store.write() as tx:
        keyed_calls.give_up(tx, this)
    with pytest.raises(CallInProgress):
        begin(store)
    with store.write() as tx:
        keyed_calls.give_up(tx, this, is_repeatable=True)
    assert isinstance(begin(store), Try)


def test_a_change_after_the_call_was_taken_over_is_undone(store: Store) -> None:
    slow = begun(store)
    begun(store)
    with keyed_calls.running(slow), pytest.raises(CallOvertaken):
        change(store)
    assert changes(store) == 0
    finish(store, slow)
    with pytest.raises(CallInProgress):
        begin(store)


def test_transactions_of_other_calls_are_not_marked(store: Store) -> None:
    begun(store)
    change(store)
    assert isinstance(begin(store, is_gone=lambda _: True), Try)


def test_answers_are_forgotten_with_a_person(store: Store) -> None:
    this = begun(store)
    finish(store, this)
    with store.write() as tx:
        keyed_calls.forget_answers(tx)
    assert isinstance(begin(store), Try)


KILLED = """
import os, signal, sys
from pathlib import Path
from app.store import keyed_calls, keys
from app.store.jobs import owners
from app.store.key_role import KeyRole
from app.store.store import Store

def die():
    os.kill(os.getpid(), signal.SIGKILL)

store, moment = Store.open(sys.argv[1], Path(sys.argv[2])), sys.argv[3]
with store.write() as tx:
    this = keyed_calls.begin(tx, "k", owners.new_owner("api"))
with keyed_calls.running(this), store.write() as tx:
    keys.create(tx, KeyRole.READ, "made by the call")
    if moment == "before":
        die()
die()
"""


@pytest.mark.parametrize("moment", ["before", "after"])
def test_a_killed_process_leaves_no_second_effect(
    store: Store, database_url: str, moment: str
) -> None:
    command = [sys.executable, "-c", KILLED, database_url, str(store.files.root), moment]
    assert subprocess.run(command, check=False).returncode == -signal.SIGKILL
    if moment == "before":
        assert changes(store) == 0
        assert isinstance(begin(store, now=datetime.now(UTC)), Try)
        return
    assert changes(store) == 1
    with pytest.raises(AnswerLost):
        begin(store, now=datetime.now(UTC))
    assert isinstance(begin(store, now=datetime.now(UTC), can_repeat=True), Try)
