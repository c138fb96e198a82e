"""The worker: claim a job, have it done, settle it; and beat while it lasts.

One thread does it all, so that a worker that hangs stops beating and its jobs go to another.
What a killed worker had in hand goes back into the queue once another worker sees that it is
dead. A worker that is told to stop gives its jobs back as if they had not been tried.
"""

from __future__ import annotations

import logging
import math
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from contextlib import contextmanager, suppress
from dataclasses import asdict
from typing import Any

from app.config import Settings
from app.errors import LeaseLost, NotFound, StorageError
from app.logs import job_id
from app.services.clips import persons, reanalysis
from app.services.library.library import Library
from app.services.training import models, refit
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx
from app.store.jobs import leases, outcomes, owners, queue
from app.store.jobs.abandoned import Watch
from app.store.jobs.record import ClaimedJob, JobKind
from app.worker.deliveries import Deliveries
from app.worker.executors import JobExecutors
from app.worker.expiry import Expiry
from app.worker.running import Running
from app.worker.sweeps import Sweeps

_log = logging.getLogger(__name__)

READ_AHEAD = 3
"""Clips claimed for each process, so that none waits while others are stored together."""
FIT_CHECK_S = 2.0
"""Between looks at whether a fit is due, while there is nothing else to do."""
STOP_WITHIN_S = 10.0
"""For work in hand to end when the worker is told to stop."""
LOOKS_PER_LEASE = 10
"""How often in the time of a lease a worker looks at what others hold."""
STORE_PAUSE_S = 1.0
"""Before the store is tried again after it failed."""


def run_worker(
    settings: Settings,
    stop_event: threading.Event,
    *,
    until: Callable[[Library], bool] | None = None,
) -> None:
    """Work until `stop_event` is set, or `until` holds (asked when there is nothing to claim)."""
    lib = Library.open(settings)
    sweeps = Sweeps(lib.store, settings.quarantine_days)
    webhooks = Deliveries(lib.store)
    try:
        swept = sweeps.begin()
        webhooks.begin()
        if not settings.recognize_persons:
            persons.remove_person_models(lib)
        outdated = reanalysis.requeue_outdated(lib)
        _log.info("worker begins", extra={"fields": {"swept": asdict(swept), "outdated": outdated}})
        worker = Worker(lib)
        try:
            worker.run(stop_event, until)
        finally:
            worker.close()
    finally:
        sweeps.end()
        webhooks.end()
        lib.close()


class Worker:
    """Works on a library's jobs."""

    def __init__(self, lib: Library) -> None:
        self.lib = lib
        settings = lib.settings
        self.owner = owners.new_owner("worker")
        self.executors = JobExecutors(lib)
        self._running: list[Running] = []
        self._last_beat = time.monotonic()
        self._watch = Watch(self.owner, settings.job_lease_s)
        self._look_s = min(settings.job_heartbeat_s, settings.job_lease_s / LOOKS_PER_LEASE)
        self._last_look = -math.inf
        self._last_fit_check = 0.0
        self._expiry = Expiry(lib)

    def run(self, stop: threading.Event, until: Callable[[Library], bool] | None = None) -> None:
        """Work until told to stop, or until `until` holds with nothing left to claim."""
        while not stop.is_set():
            try:
                self._beat_if_due()
                self._expiry.remove_if_due()
                self._recover_if_due()
                is_idle = not self.turn()
                if is_idle and not self._running:
                    if until is not None and until(self.lib):
                        return
                    self._request_fit_if_due()
            except StorageError:
                _log.exception("the store failed; trying again")
                stop.wait(STORE_PAUSE_S)
            self._wait(stop)

    def close(self) -> None:
        """Give back what is in hand, and end the processes."""
        for running in self._running:
            running.stop()
        # An import's thread must have stopped before another worker goes on with it.
        wait(_futures(self._running), timeout=STOP_WITHIN_S)
        for running in self._running:
            with suppress(LeaseLost, NotFound, StorageError), self.lib.store.write() as tx:
                outcomes.give_back(tx, running.claimed)
        self._running = []
        self.executors.close()

    @property
    def held(self) -> tuple[Running, ...]:
        """The jobs in hand."""
        return tuple(self._running)

    def turn(self) -> bool:
        """Settle what is finished and claim what there is room for; whether there was any work.

        All in one transaction, because each transaction waits for the disk.
        """
        finished = [running for running in self._running if running.future.done()]
        if not finished and not self._is_work_waiting():
            return False
        with self.lib.store.write() as tx:
            self._settle_all(tx, finished)
            claimed = self._claim_all(tx, without=finished)
            ids = [each.clip_id for each in claimed if each.clip_id is not None]
            clip_of = clips.get_many(tx, ids)
        self._running = [running for running in self._running if running not in finished]
        for each in claimed:
            self._begin(each, clip_of.get(each.clip_id or ""))
        return bool(finished or claimed)

    def _settle_all(self, tx: Tx, finished: list[Running]) -> None:
        for running in finished:
            with _job_named(running.claimed.job.id):
                self._settle(tx, running)
        ids = [running.claimed.clip_id for running in finished]
        outcomes.settle_imports(tx, [clip_id for clip_id in ids if clip_id is not None])

    def _settle(self, tx: Tx, running: Running) -> None:
        """Settle one; what is not ours any more says so before it changes anything."""
        try:
            running.settle(tx)
        except LeaseLost:
            _log.warning("job %s was given to another worker", running.claimed.job.id)
        except CancelledError:
            _log.info("job %s was stopped", running.claimed.job.id)

    def _beat_if_due(self) -> None:
        settings = self.lib.settings
        if not self._running or time.monotonic() - self._last_beat < settings.job_heartbeat_s:
            return
        self._last_beat = time.monotonic()
        for running in list(self._running):
            progress, detail = running.progress()
            try:
                with self.lib.store.write() as tx:
                    is_canceled = leases.heartbeat(
                        tx,
                        running.claimed.lease,
                        progress=progress,
                        detail=detail,
                    )
            except LeaseLost:
                self._drop(running)
            else:
                if is_canceled:
                    self._cancel(running)

    def _recover_if_due(self) -> None:
        """Look for jobs of dead workers; a read, unless there are any."""
        if time.monotonic() - self._last_look < self._look_s:
            return
        self._last_look = time.monotonic()
        with self.lib.store.read() as tx:
            abandoned = self._watch.look(tx)
        if not abandoned:
            return
        with self.lib.store.write() as tx:
            for job in queue.recover(tx, self._watch, abandoned):
                _log.warning("the worker of job %s is dead; the job is %s", job.id, job.state)

    def _cancel(self, running: Running) -> None:
        self._drop(running)
        with suppress(LeaseLost), self.lib.store.write() as tx:
            outcomes.finish_canceled(tx, running.claimed)

    def _drop(self, running: Running) -> None:
        running.stop()
        self._running.remove(running)

    def _is_work_waiting(self) -> bool:
        """Whether there is anything to claim; an idle worker only reads."""
        kinds = self._kinds_with_room([running.claimed for running in self._running])
        if not kinds:
            return False
        with self.lib.store.read() as tx:
            return queue.is_work_waiting(tx, kinds)

    def _claim_all(self, tx: Tx, without: list[Running]) -> list[ClaimedJob]:
        """Claim what there is room for, when these are settled."""
        held = [running.claimed for running in self._running if running not in without]
        claimed: list[ClaimedJob] = []
        while kinds := self._kinds_with_room([*held, *claimed]):
            found = queue.take(tx, kinds, self.owner)
            if found is None:
                break
            claimed.append(found)
        return claimed

    def _kinds_with_room(self, held: Iterable[ClaimedJob]) -> list[JobKind]:
        kinds_held = [claimed.job.kind for claimed in held]
        busy = kinds_held.count(JobKind.INGEST) + kinds_held.count(JobKind.FIT)
        kinds = []
        if busy < READ_AHEAD * self.executors.slots:
            kinds.append(JobKind.INGEST)
        if JobKind.IMPORT not in kinds_held:
            kinds.append(JobKind.IMPORT)
        if busy < self.executors.slots and JobKind.FIT not in kinds_held:
            kinds.append(JobKind.FIT)
        return kinds

    def _begin(self, claimed: ClaimedJob, clip: ClipRecord | None) -> None:
        if claimed.job.kind is JobKind.FIT and not self._running:
            self.executors.rest()
        self._running.append(self.executors.begin(claimed, clip))

    def _request_fit_if_due(self) -> None:
        if time.monotonic() - self._last_fit_check < FIT_CHECK_S:
            return
        self._last_fit_check = time.monotonic()
        with self.lib.store.read() as tx:
            is_due = refit.is_fit_due(tx, self.lib.settings.refit_growth)
        if is_due:
            with self.lib.store.write() as tx:
                models.enqueue_fit(tx)

    def _wait(self, stop: threading.Event) -> None:
        """Until something finishes, or it is time to look for work again."""
        pause = self.lib.settings.job_poll_s
        if self._running:
            wait(_futures(self._running), timeout=pause, return_when=FIRST_COMPLETED)
        else:
            stop.wait(pause)


def _futures(running: Iterable[Running]) -> list[Future[Any]]:
    return [each.future for each in running]


@contextmanager
def _job_named(name: str) -> Iterator[None]:
    """Logs within carry the job's id."""
    token = job_id.set(name)
    try:
        yield
    finally:
        job_id.reset(token)
