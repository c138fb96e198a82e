"""Webhooks in the store: what is delivered next, when it is tried again, and when it ends."""

from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest

from app.errors import WebhookNotFound
from app.store.jobs import outcomes, queue
from app.store.jobs import repository as jobs
from app.store.jobs.endings import EVENTS
from app.store.jobs.record import JobKind, NewJob
from app.store.store import Store
from app.store.webhooks import deliveries
from app.store.webhooks import repository as webhooks
from app.store.webhooks.deliveries import (
    FIRST_DELAY_SECONDS,
    MAX_DELAY_SECONDS,
    MAX_FAILURES,
    TAKEN_SECONDS,
    Delivery,
    Event,
    Outcome,
)
from tests.store.conftest import AddClip

NOW = datetime(2026, 1, 2, tzinfo=UTC)
FAILED = Outcome(is_delivered=False, status=500, detail="The receiver answered 500.")
RECEIVED = Outcome(is_delivered=True, status=204)


def add(store: Store, *events: str, name: str = "a") -> str:
    with store.write() as tx:
        return webhooks.add(tx, f"https://{name}.example/", "whsec_" + "A" * 32, events).id


def publish(store: Store, *names: str) -> None:
    with store.write() as tx:
        deliveries.publish(tx, [Event(name, {"number": n}) for n, name in enumerate(names)])


def take(store: Store, now: datetime = NOW) -> tuple[Delivery, ...]:
    with store.write() as tx:
        is_due = deliveries.is_any_due(tx, now=now)
        taken = deliveries.take_due(tx, 10, now=now)
        assert is_due == bool(taken)
        return taken


def settle(store: Store, tried: Delivery, outcome: Outcome, now: datetime = NOW) -> None:
    with store.write() as tx:
        deliveries.settle(tx, tried, outcome, now=now)


def shown(store: Store, webhook_id: str) -> webhooks.WebhookRecord:
    with store.read() as tx:
        return webhooks.get(tx, webhook_id)


def test_each_webhook_receives_its_events_in_order(store: Store) -> None:
    all_events, fits = add(store), add(store, "fit.failed", name="b")
    publish(store, "ingest.succeeded", "fit.failed")
    first = {one.webhook_id: one for one in take(store)}
    assert first[all_events].event == "ingest.succeeded"
    assert first[fits].event == "fit.failed"
    assert json.loads(first[fits].body)["data"] == {"number": 1}
    assert take(store) == ()
    for one in first.values():
        settle(store, one, RECEIVED)
    (second,) = take(store)
    assert (second.webhook_id, second.event, second.attempt) == (all_events, "fit.failed", 1)
    assert shown(store, fits).pending == 0
    assert shown(store, all_events).pending == 1


def test_a_delivery_whose_worker_died_is_taken_again(store: Store) -> None:
    add(store)
    publish(store, "fit.failed")
    (lost,) = take(store)
    assert take(store, NOW + timedelta(seconds=TAKEN_SECONDS - 1)) == ()
    (again,) = take(store, NOW + timedelta(seconds=TAKEN_SECONDS))
    assert (again.id, again.attempt) == (lost.id, 2)
    settle(store, lost, FAILED)  # its worker was only slow: the second try counts
    assert shown(store, again.webhook_id).last_delivery is None
    settle(store, again, RECEIVED)
    assert shown(store, again.webhook_id).pending == 0


def test_a_failing_webhook_is_tried_later_and_later_and_then_switched_off(store: Store) -> None:
    webhook_id, now, waits = add(store), NOW, []
    publish(store, "fit.failed", "fit.failed")
    for failures in range(1, MAX_FAILURES):
        (one,) = take(store, now)
        assert one.attempt == failures
        settle(store, one, FAILED, now)
        found = shown(store, webhook_id)
        assert (found.failures, found.is_enabled, found.pending) == (failures, True, 2)
        wait = min(FIRST_DELAY_SECONDS * 2 ** (failures - 1), MAX_DELAY_SECONDS)
        assert take(store, now + timedelta(seconds=wait - 1)) == ()
        now += timedelta(seconds=wait)
        waits.append(wait)
    assert sum(waits) > 20 * 3600
    settle(store, take(store, now)[0], FAILED, now)
    off = shown(store, webhook_id)
    assert (off.is_enabled, off.pending, off.failures) == (False, 0, MAX_FAILURES)
    publish(store, "fit.failed")
    assert take(store, now) == ()


def test_a_clock_that_was_set_back_postpones_nothing(store: Store) -> None:
    add(store)
    publish(store, "fit.failed")
    settle(store, take(store)[0], FAILED)
    assert take(store, NOW - timedelta(days=365)) != ()


def test_a_receiver_that_is_gone_is_switched_off_at_once(store: Store) -> None:
    webhook_id = add(store)
    publish(store, "fit.failed")
    gone = Outcome(is_delivered=False, status=410, detail="gone", is_gone=True)
    settle(store, take(store)[0], gone)
    assert not shown(store, webhook_id).is_enabled


def test_switched_off_it_forgets_its_events_and_on_it_is_due_at_once(store: Store) -> None:
    webhook_id = add(store)
    publish(store, "fit.failed")
    settle(store, take(store)[0], FAILED)
    with store.write() as tx:
        assert webhooks.change(tx, webhook_id, is_enabled=False).pending == 0
        webhooks.change(tx, webhook_id, is_enabled=True, events=["fit.canceled"])
    publish(store, "fit.failed", "fit.canceled")
    assert [one.event for one in take(store)] == ["fit.canceled"]


def test_a_test_event_is_sent_once_to_a_webhook_that_is_off(store: Store) -> None:
    webhook_id = add(store)
    with store.write() as tx:
        webhooks.change(tx, webhook_id, is_enabled=False)
        deliveries.add(tx, webhook_id, Event("webhook.test", {}))
    settle(store, take(store)[0], FAILED)
    found = shown(store, webhook_id)
    assert (found.pending, found.is_enabled) == (0, False)
    assert found.last_delivery is not None
    assert found.last_delivery["detail"] == FAILED.detail


def test_removing_a_webhook_removes_its_events(store: Store) -> None:
    webhook_id = add(store)
    publish(store, "fit.failed")
    (taken,) = take(store)
    with store.write() as tx:
        webhooks.remove(tx, webhook_id)
    settle(store, taken, FAILED)
    with store.read() as tx:
        assert webhooks.list_all(tx) == ()
        with pytest.raises(WebhookNotFound):
            webhooks.get(tx, webhook_id)


def _last_event(store: Store, webhook_id: str) -> dict[str, Any]:
    (taken,) = take(store)
    settle(store, taken, RECEIVED)
    event: dict[str, Any] = json.loads(taken.body)
    return event


def test_every_end_of_a_job_is_an_event(store: Store, add_clip: AddClip) -> None:
    webhook_id = add(store)
    clip = add_clip("walk")
    with store.write() as tx:
        job = jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id))
        claimed = queue.take(tx, [JobKind.INGEST], "me")
        assert claimed is not None
        outcomes.fail_job(tx, claimed, {"code": "unreadable", "detail": "Bad."})
    failed = _last_event(store, webhook_id)
    assert failed["type"] == "ingest.failed"
    assert failed["data"]["error"]["code"] == "unreadable"
    assert {name: failed["data"][name] for name in ("id", "kind", "state", "clip_id")} == {
        "id": job.id,
        "kind": "ingest",
        "state": "failed",
        "clip_id": clip.id,
    }
    with store.write() as tx:
        outcomes.request_cancel(tx, jobs.enqueue(tx, NewJob(JobKind.FIT)).id)
    assert _last_event(store, webhook_id)["type"] == "fit.canceled"
    with store.write() as tx:
        jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id))
        outcomes.remove_clip(tx, clip.id)
    assert _last_event(store, webhook_id)["type"] == "ingest.canceled"
    assert len(EVENTS) == 12


def test_an_event_is_stored_only_if_its_job_ends(store: Store) -> None:
    webhook_id = add(store)
    with store.write() as tx:
        job = jobs.enqueue(tx, NewJob(JobKind.FIT))

    def canceled_in_vain() -> None:
        with store.write() as tx:
            outcomes.request_cancel(tx, job.id)
            raise RuntimeError

    with pytest.raises(RuntimeError):
        canceled_in_vain()
    assert shown(store, webhook_id).pending == 0
