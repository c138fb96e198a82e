"""The state of the library as metrics for Prometheus, read when Prometheus asks."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from datetime import datetime

from prometheus_client.core import GaugeMetricFamily, Metric, SummaryMetricFamily
from prometheus_client.registry import Collector

from app.errors import StorageError
from app.services.library.library import Library
from app.store import workers
from app.store.clips.record import ClipState
from app.store.database.ids import utc_now
from app.store.jobs.record import OPEN_STATES, JobKind, JobState
from app.store.stage_times import StageTime
from app.store.upkeep import census
from app.store.upkeep.census import Census, Space
from app.store.workers import LivingWorker

_log = logging.getLogger(__name__)

CACHE_S = 5.0
"""Answers within this time are the same, so that many scrapers cost as much as one."""
ALIVE, SILENT = "alive", "silent"
"""States of workers. A silent worker has sent no heartbeat during a whole lease."""

Samples = Mapping[tuple[str, ...], float]
"""Values by the values of the labels."""


class LibraryMetrics(Collector):
    """A collector of the metrics of one library. It is safe to share between threads."""

    def __init__(self, library: Callable[[], Library | None]) -> None:
        """library: returns the open library, or None before it is open."""
        self._library = library
        self._lock = threading.Lock()
        self._metrics: list[Metric] = []
        self._expires = 0.0

    def collect(self) -> Iterable[Metric]:
        """The metrics of now, or of at most CACHE_S seconds ago."""
        library = self._library()
        if library is None:
            return []
        with self._lock:
            if time.monotonic() >= self._expires:
                self._metrics = _metrics_of(library)
                self._expires = time.monotonic() + CACHE_S
            return self._metrics


def _metrics_of(lib: Library) -> list[Metric]:
    """All metrics. If the database cannot be read, only those that do not need it."""
    found = [*_of_index(lib), *_of_workers(lib), *_of_space(census.measure_space(lib.store))]
    try:
        counted = census.count(lib.store)
    except StorageError:
        _log.exception("the library could not be counted for the metrics")
        return [*found, _up(False)]
    return [*found, _up(True), *_of_jobs(counted), *_of_clips(counted), *_of_models(counted)]


def _up(is_up: bool) -> Metric:
    return _gauge("kinedex_database_up", "1 if the database can be read, 0 if not.", {(): is_up})


def _of_index(lib: Library) -> Iterator[Metric]:
    yield _gauge(
        "kinedex_index_clips", "Clips in the index for searches.", {(): float(len(lib.index))}
    )
    yield _gauge(
        "kinedex_index_version",
        "Version of the library in the index; the next search brings it to "
        "kinedex_library_version.",
        {(): float(lib.index.version)},
    )


def _of_workers(lib: Library) -> Iterator[Metric]:
    found = workers.living(lib.store.files.root)
    states = [_state(worker, lib.settings.job_lease_s) for worker in found]
    yield _gauge(
        "kinedex_workers",
        "Workers whose process lives; a silent worker hangs: its last heartbeat is too old.",
        {(state,): float(states.count(state)) for state in (ALIVE, SILENT)},
        "state",
    )
    yield _gauge(
        "kinedex_workers_resident_memory_bytes",
        "Resident memory of all workers, without their analysis processes.",
        {(): float(sum(worker.memory_bytes for worker in found))},
    )


def _state(worker: LivingWorker, lease_s: float) -> str:
    return ALIVE if worker.age_s < lease_s else SILENT


def _of_space(space: Space) -> Iterator[Metric]:
    yield _gauge(
        "kinedex_disk_free_bytes",
        "Free space on the disk of a folder.",
        {(name,): float(free) for name, free in space.free.items()},
        "folder",
    )
    yield _gauge(
        "kinedex_database_bytes",
        "Size of the database and its log; 0 for a database server.",
        {(): float(space.database)},
    )


def _of_jobs(counted: Census) -> Iterator[Metric]:
    pairs = [(kind.value, state.value) for kind in JobKind for state in JobState]
    yield _gauge(
        "kinedex_jobs",
        "Jobs by kind and state. Jobs that have ended are removed after some days.",
        {pair: float(counted.jobs.get(pair, 0)) for pair in pairs},
        "kind",
        "state",
    )
    yield _gauge(
        "kinedex_oldest_job_age_seconds",
        "Time since the oldest open job was made; 0 without such a job.",
        {
            pair: _age(counted.oldest.get(pair))
            for pair in pairs
            if pair[1] in {state.value for state in OPEN_STATES}
        },
        "kind",
        "state",
    )
    yield _gauge(
        "kinedex_failed_jobs",
        "Failed jobs by kind and code of the problem.",
        {pair: float(number) for pair, number in counted.failed_jobs.items()},
        "kind",
        "code",
    )
    yield _stages(counted.stages)


def _stages(stages: Iterable[StageTime]) -> Metric:
    metric = SummaryMetricFamily(
        "kinedex_analysis_stage_seconds",
        "Time that each stage of the analyses of clips took, since the library was made.",
        labels=["stage"],
    )
    for one in stages:
        metric.add_metric([one.stage], count_value=one.count, sum_value=one.seconds)
    return metric


def _of_clips(counted: Census) -> Iterator[Metric]:
    yield _gauge(
        "kinedex_clips",
        "Clips by state.",
        {(state.value,): float(counted.clips.get(state.value, 0)) for state in ClipState},
        "state",
    )
    yield _gauge(
        "kinedex_failed_clips",
        "Failed clips by code of the problem.",
        {(code,): float(number) for code, number in counted.failed_clips.items()},
        "code",
    )
    yield _gauge(
        "kinedex_library_version",
        "Version of the library: it grows with every change that a search can see.",
        {(): float(counted.library_version)},
    )


def _of_models(counted: Census) -> Iterator[Metric]:
    yield _gauge(
        "kinedex_model_age_seconds",
        "Time since the current model was fitted.",
        {(kind,): _age(fitted) for kind, fitted in counted.models.items()},
        "kind",
    )


def _age(moment: datetime | None) -> float:
    return 0.0 if moment is None else max((utc_now() - moment).total_seconds(), 0.0)


def _gauge(name: str, text: str, samples: Samples, *labels: str) -> Metric:
    """A gauge with a sample for each combination of label values."""
    metric = GaugeMetricFamily(name, text, labels=labels)
    for values, value in samples.items():
        metric.add_metric(values, value)
    return metric
