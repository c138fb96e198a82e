"""The worker: it claims a job, starts it, sends heartbeats while it runs, and settles it.

One thread does all of this. So a worker that hangs sends no heartbeats, its jobs go to another
worker, and `kinedex worker --check` reports it. The jobs of a killed worker go back into the queue
when another worker sees that it is dead. A worker that gets a signal to stop puts its jobs back;
that does not count as an attempt.
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
from app.models.keyposes.thresholds import Thresholds
from app.services.clips import persons, reanalysis
from app.services.library.keypose_thresholds import library_thresholds
from app.services.library.library import Library
from app.services.training import models, refit
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx
from app.store.database.signals import Listener, Signal
from app.store.jobs import leases, outcomes, owners, queue
from app.store.jobs.abandoned_jobs import Watch
from app.store.jobs.record import ClaimedJob, JobKind
from app.store.workers import Heartbeat
from app.worker.curating import Curating
from app.worker.deliveries import Deliveries
from app.worker.executors import JobExecutors
from app.worker.expiry import Expiry
from app.worker.learned_thresholds import LearnedThresholds
from app.worker.running import RunningJob
from app.worker.sweeps import Sweeps

_log = logging.getLogger(__name__)

READ_AHEAD = 4
"""Clips claimed for each analysis process, so that none is idle while results are stored."""
KEPT_BUSY = 2
"""While more clips than this are claimed for each analysis process, results may wait for others to
be stored with them: a transaction costs as much CPU as a clip in it."""
MAX_GATHER_S = 0.2
"""The longest time that a result waits for others."""
FIT_CHECK_S = 2.0
"""Time between two checks whether a fit is due, while there is nothing else to do."""
STOP_TIMEOUT_S = 10.0
"""How long a worker that stops waits for its running jobs."""
WATCHES_PER_LEASE = 10
"""How often in the time of a lease a worker looks at the jobs of other workers."""
_ONE_AT_A_TIME = (JobKind.FIT, JobKind.EVALUATE)
"""Kinds of jobs in a process of their own, which needs much memory."""
LISTENING_POLL_S = 1.0
"""Time after which an idle worker looks for work even without a signal: a job may be due again."""
STOP_LOOK_S = 0.25
"""How often a worker that waits for a signal looks whether it should stop."""
STORE_PAUSE_S = 1.0
"""Time before another attempt after the store failed."""


def run_worker(
    settings: Settings,
    stop_event: threading.Event,
    *,
    until: Callable[[Library], bool] | None = None,
) -> None:
    """Work until `stop_event` is set, or until `until` returns True.

    `until` is called only when the worker has no job and finds none to claim. Raises
    ConfigurationError, StorageError if the library cannot be opened.
    """
    lib = Library.open(settings)
    sweeps = Sweeps(lib.store, settings.quarantine_days)
    webhooks = Deliveries(lib.store)
    curating = Curating(lib)
    try:
        swept = sweeps.begin()
        webhooks.begin()
        curating.begin()
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
        curating.end()
        lib.close()


class Worker:
    """Does the jobs of a library."""

    def __init__(self, lib: Library) -> None:
        self.lib = lib
        settings = lib.settings
        self.owner = owners.new_owner("worker")
        self.executors = JobExecutors(lib)
        self._running: list[RunningJob] = []
        self._heartbeat = Heartbeat(settings.files_dir, self.owner, settings.job_heartbeat_s)
        self._last_beat = time.monotonic()
        self._watch = Watch(self.owner, settings.job_lease_s)
        self._watch_s = min(settings.job_heartbeat_s, settings.job_lease_s / WATCHES_PER_LEASE)
        self._last_watch = -math.inf
        self._last_fit_check = 0.0
        self._wake = threading.Event()
        self._signals = Listener(lib.store.database, [Signal.QUEUE], self._wake.set)
        self._thresholds = LearnedThresholds(lib)
        self._expiry = Expiry(lib)

    def run(self, stop: threading.Event, until: Callable[[Library], bool] | None = None) -> None:
        """Work until `stop` is set, or until there is no job left and `until` returns True."""
        self._signals.begin()
        while not stop.is_set():
            try:
                self._beat_if_due()
                self._expiry.remove_if_due()
                self._recover_if_due()
                is_idle = not (self.turn() or self._has_requeued())
                if is_idle and not self._running and until is not None and until(self.lib):
                    return
                if is_idle and self._may_fit():
                    self._request_fit_if_due()
                # A worker whose store fails sends none: it does no work.
                self._heartbeat.beat_if_due()
            except StorageError:
                _log.exception("the store failed; trying again")
                stop.wait(STORE_PAUSE_S)
            self._wait(stop)

    def close(self) -> None:
        """Put the running jobs back into the queue, and end the processes."""
        self._signals.end()
        for running in self._running:
            running.stop()
        # An import's thread must have stopped before another worker goes on with it.
        wait(_futures(self._running), timeout=STOP_TIMEOUT_S)
        for running in self._running:
            with suppress(LeaseLost, NotFound, StorageError), self.lib.store.write() as tx:
                outcomes.give_back(tx, running.claimed)
        self._running = []
        self.executors.close()
        self._heartbeat.end()

    @property
    def running(self) -> tuple[RunningJob, ...]:
        """The jobs that this worker has claimed and not settled yet."""
        return tuple(self._running)

    def turn(self) -> bool:
        """Settle finished jobs and claim new ones while there is room. False if there were none.

        All of this is one transaction, because each transaction waits for the disk.
        """
        finished = [running for running in self._running if running.future.done()]
        if not finished and not self._is_work_waiting():
            return False
        # Before any job is claimed: after a failure here, no job must be left claimed.
        thresholds = library_thresholds(self.lib)
        with self.lib.store.write() as tx:
            self._settle_all(tx, finished)
            claimed = self._claim_all(tx, without=finished)
            ids = [each.clip_id for each in claimed if each.clip_id is not None]
            clip_of = clips.get_many(tx, ids)
        self._running = [running for running in self._running if running not in finished]
        for each in claimed:
            self._begin(each, clip_of.get(each.clip_id or ""), thresholds)
        return bool(finished or claimed)

    def _settle_all(self, tx: Tx, finished: list[RunningJob]) -> None:
        for running in finished:
            with _job_named(running.claimed.job.id):
                self._settle(tx, running)
        ids = [running.claimed.clip_id for running in finished]
        outcomes.settle_imports(tx, [clip_id for clip_id in ids if clip_id is not None])

    def _settle(self, tx: Tx, running: RunningJob) -> None:
        """Settle one job. If another worker has it, the lease fails before any change."""
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
                with self.lib.store.database.write_row() as tx:
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
        """Put jobs of dead workers back. It writes only if there are any."""
        if time.monotonic() - self._last_watch < self._watch_s:
            return
        self._last_watch = time.monotonic()
        with self.lib.store.read() as tx:
            abandoned = self._watch.look(tx)
        if not abandoned:
            return
        with self.lib.store.write() as tx:
            for job in queue.recover(tx, self._watch, abandoned):
                _log.warning("the worker of job %s is dead; the job is %s", job.id, job.state)

    def _cancel(self, running: RunningJob) -> None:
        self._drop(running)
        with suppress(LeaseLost), self.lib.store.write() as tx:
            outcomes.finish_canceled(tx, running.claimed)

    def _drop(self, running: RunningJob) -> None:
        running.stop()
        self._running.remove(running)

    def _is_work_waiting(self) -> bool:
        """Whether there is a job to claim. An idle worker only reads, so others can write."""
        kinds = self._kinds_with_room([running.claimed for running in self._running])
        if not kinds:
            return False
        with self.lib.store.read() as tx:
            return queue.is_work_waiting(tx, kinds)

    def _claim_all(self, tx: Tx, without: list[RunningJob]) -> list[ClaimedJob]:
        """Claim jobs while there is room. The jobs of `without` do not count: they are settled."""
        running = [each.claimed for each in self._running if each not in without]
        claimed: list[ClaimedJob] = []
        while kinds := self._kinds_with_room([*running, *claimed]):
            next_job = queue.take(tx, kinds, self.owner)
            if next_job is None:
                break
            claimed.append(next_job)
        return claimed

    def _kinds_with_room(self, running: Iterable[ClaimedJob]) -> list[JobKind]:
        """The kinds of jobs to claim: one import, one fit, one evaluation, and analyses ahead."""
        running_kinds = [claimed.job.kind for claimed in running]
        busy = sum(kind is not JobKind.IMPORT for kind in running_kinds)
        kinds = []
        if busy < READ_AHEAD * self.executors.slots:
            kinds.append(JobKind.INGEST)
        if JobKind.IMPORT not in running_kinds:
            kinds.append(JobKind.IMPORT)
        if busy < self.executors.slots:
            kinds += [kind for kind in _ONE_AT_A_TIME if kind not in running_kinds]
        return kinds

    def _begin(self, claimed: ClaimedJob, clip: ClipRecord | None, thresholds: Thresholds) -> None:
        if claimed.job.kind in _ONE_AT_A_TIME and not self._running:
            self.executors.rest()  # they need much memory
        self._running.append(self.executors.begin(claimed, clip, thresholds))

    def _may_fit(self) -> bool:
        """Whether nothing runs but an evaluation: a fit does not wait for its end."""
        return all(each.claimed.job.kind is JobKind.EVALUATE for each in self._running)

    def _has_requeued(self) -> bool:
        """Whether clips have been queued because a fit has learned other thresholds."""
        return self._may_fit() and self._thresholds.requeue_if_changed()

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
        """Wait until jobs finish, or until it is time to look for work again."""
        pause = self.lib.settings.job_poll_s
        if not self._running:
            if self._signals.is_listening:
                self._wait_for_signal(stop, max(pause, LISTENING_POLL_S))
            else:
                stop.wait(pause)
            return
        wait(_futures(self._running), timeout=pause, return_when=FIRST_COMPLETED)
        self._gather()

    def _gather(self) -> None:
        """Wait for more finished jobs while the analysis processes have enough to do."""
        end = time.monotonic() + MAX_GATHER_S
        while (left := end - time.monotonic()) > 0:
            futures = [future for future in _futures(self._running) if not future.done()]
            are_none_done = len(futures) == len(self._running)
            if are_none_done or len(futures) <= KEPT_BUSY * self.executors.slots:
                return
            wait(futures, timeout=left, return_when=FIRST_COMPLETED)

    def _wait_for_signal(self, stop: threading.Event, seconds: float) -> None:
        """Wait until a job is queued, at most so long."""
        deadline = time.monotonic() + seconds
        while not stop.is_set() and (left := deadline - time.monotonic()) > 0:
            if self._wake.wait(min(left, STOP_LOOK_S)):
                break
        self._wake.clear()


def _futures(running: Iterable[RunningJob]) -> list[Future[Any]]:
    return [each.future for each in running]


@contextmanager
def _job_named(name: str) -> Iterator[None]:
    """Log lines within the block carry the job's id."""
    token = job_id.set(name)
    try:
        yield
    finally:
        job_id.reset(token)
