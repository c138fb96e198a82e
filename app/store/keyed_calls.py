"""Calls with an Idempotency-Key: each takes effect once, and a repeated call gets its answer.

A call is `running` first. The transaction that makes its change also makes it `committed`, so that
nobody can see the change without this mark. When the answer is known, the call is `answered`.

If the process dies before the change, the next call with the key runs anew. If it dies between
the change and the answer, the answer is lost: then the next call says so, and changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum

from sqlalchemy import and_, bindparam, delete, insert, select, update

from app.errors import AnswerLost, CallInProgress, CallOvertaken
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.service_tables import keyed_calls
from app.store.jobs import owners

KEPT = timedelta(hours=24)
"""How long an answer is kept."""


class CallState(StrEnum):
    """The state of a call with a key."""

    RUNNING = "running"
    """It has changed nothing yet."""
    COMMITTED = "committed"
    """It has changed something; its answer is not stored yet."""
    ANSWERED = "answered"
    """Its answer is stored."""


@dataclass(frozen=True, slots=True)
class Try:
    """The right to run a call. It is void once another process has taken the call over."""

    key_sha256: str
    try_id: str


@dataclass(frozen=True, slots=True)
class Answer:
    """A stored answer. content_sha256: of what the call sent; media_type: None without a body."""

    content_sha256: str
    status: int
    media_type: str | None
    body: bytes


def begin(
    tx: Tx,
    key_sha256: str,
    owner: str,
    *,
    can_repeat: bool = False,
    now: datetime | None = None,
    is_gone: Callable[[str], bool] = owners.is_gone,
) -> Try | Answer:
    """Begin a call, or return the answer that it had.

    can_repeat: a second run changes nothing, so a lost answer can be made again. Raises
    CallInProgress while another process or thread runs the call, AnswerLost.
    """
    now = now or utc_now()
    tx.execute(delete(keyed_calls).where(keyed_calls.c.created_at < now - KEPT))
    row = tx.execute(_ONE, {"the_key": key_sha256}).mappings().one_or_none()
    values = {
        "state": CallState.RUNNING.value,
        "owner": owner,
        "try_id": new_id("try"),
        "created_at": now,
    }
    if row is None:
        tx.execute(insert(keyed_calls).values(key_sha256=key_sha256, **values))
        return Try(key_sha256, str(values["try_id"]))
    if row["state"] == CallState.ANSWERED:
        return Answer(row["content_sha256"], row["status"], row["media_type"], row["body"])
    if not is_gone(row["owner"]):
        raise CallInProgress
    if row["state"] == CallState.COMMITTED and not can_repeat:
        raise AnswerLost
    tx.execute(update(keyed_calls).where(_IS_KEY).values(values), {"the_key": key_sha256})
    return Try(key_sha256, str(values["try_id"]))


@contextmanager
def running(this: Try | None) -> Iterator[None]:
    """Mark each write transaction of the block as a change of this call (`mark`); None: of none."""
    token = _current.set(this)
    try:
        yield
    finally:
        _current.reset(token)


def mark(tx: Tx) -> None:
    """Mark the call that runs as committed, if one runs.

    Each write transaction ends with it. Raises CallOvertaken if the call was given up meanwhile,
    so that its change is undone.
    """
    this = _current.get()
    if this is not None and not tx.execute(_MARK, _names(this)).rowcount:
        raise CallOvertaken


def finish(tx: Tx, this: Try, answer: Answer) -> None:
    """Store the answer of a call."""
    values = {
        "state": CallState.ANSWERED.value,
        "content_sha256": answer.content_sha256,
        "status": answer.status,
        "media_type": answer.media_type,
        "body": answer.body,
    }
    tx.execute(update(keyed_calls).where(_IS_TRY).values(values), _names(this))


def give_up(tx: Tx, this: Try, *, is_repeatable: bool = False) -> None:
    """Forget a call that changed nothing, so that it can be made again.

    is_repeatable: also if it changed something.
    """
    given_up = delete(keyed_calls).where(_IS_TRY)
    if not is_repeatable:
        given_up = given_up.where(keyed_calls.c.state == CallState.RUNNING.value)
    tx.execute(given_up, _names(this))


def forget_answers(tx: Tx) -> None:
    """Forget all answers, because they may name a person who is to be forgotten."""
    tx.execute(delete(keyed_calls).where(keyed_calls.c.state == CallState.ANSWERED.value))


_current: ContextVar[Try | None] = ContextVar("keyed_call", default=None)
_IS_KEY = keyed_calls.c.key_sha256 == bindparam("the_key")
_IS_TRY = and_(_IS_KEY, keyed_calls.c.try_id == bindparam("the_try"))
_ONE = select(keyed_calls).where(_IS_KEY)
_MARK = update(keyed_calls).where(_IS_TRY).values(state=CallState.COMMITTED.value)


def _names(this: Try) -> dict[str, str]:
    return {"the_key": this.key_sha256, "the_try": this.try_id}
