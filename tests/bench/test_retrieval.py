"""Query by example on real clips: clips with the query's task are relevant, without the query.

Run: pytest -m bench -s tests/bench/test_retrieval.py
All choices were made on dataset 1, on CMU's clips, on the demo library and on the styles active,
exhausted, masculine and youthful of dataset 2 (searched among themselves). The report half are the
styles elderly, feminine and normal of dataset 2. It was used for the first time after all choices.
Its clips search all of dataset 2, as in the targets of issue 4. (The figures of an earlier method
on all of dataset 2 were known before the split: P@20 .679, MAP .649.)

The first test prints the effect of single changes of the chosen method on the choice sets. The
changes below were tried earlier on these sets and rejected. The two figures are MAP: the mean of
the four sets alone, then all sets as one library (before the change: .788, .679):
DTW symmetric (diagonals count double) .717 .598 for .751 .643; squared cost .721 .618, square
root .754 .631; ends free by a tenth .757 .655, by a quarter .714 .610; band .1 .741 .631, .2
.748 .642; no velocities .755 .648; positions less the clip's mean .735 .612; joints by group
(trunk, arms, legs, hands, feet x .5 to 2) within .005; yaw slowed by 1 s, x 4 .804 .726; with
the movement about slow places .829 .770: there the cause was found, that waving and raising,
walking and turning differ in no single frame, while the style is in each frame. The same as
means over the clip, in the motion vector, is .848 .794 alone, and DTW on such features added
nothing to it. Re-ranking of that vector: averages with the query's neighbours (alpha-QE) .850
.795 at best and worse with more; each clip averaged with its own .862 .807; distances less
half the neighbours' radius .860 .800; k-reciprocal Jaccard gained .02 on the former vector and
lost where classes are large; diffusion alone .850 .792, with the distance .868 .817.
"""

from __future__ import annotations

import csv
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from app.analysis.descriptors import motion_vector
from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.config import Settings
from app.demo import demo_clips
from app.formats.read import read_recording
from app.models.held_out.ranking import average_precision
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_track
from app.numerics import diffusion
from app.numerics.alignment.dtw import dtw_distances
from app.search.example import fusion
from app.search.example.methods import LEARNED, Method
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.fields import MAX_LIMIT
from app.services.find import find
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.imports import imports
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from app.worker.loop import run_worker
from tests.bench.page import Section
from tests.real_clips import manifest, real_clips
from tests.search.fused import fused_distances

FIGURES = Section(
    "retrieval",
    "Query by example",
    trials="each of the 350 clips of dataset 2 is a query; the report half was used for no choice",
    chance=".10 for the nearest clip: ten tasks of equal size",
)

pytestmark = pytest.mark.bench

REPORT_STYLES = ("elderly", "feminine", "normal")
TARGETS = {"nearest": 0.995, "at_20": 0.90, "mean_average_precision": 0.75}
"""Targets of issue 4 for the default method on the report half. They are printed, not reached."""
FLOORS = {"nearest": 0.985, "at_20": 0.73, "mean_average_precision": 0.70}
"""Asserted: the figures of that half (.993, .748, .721), less what a changed analysis may move."""
SETS = ("dataset 2", "dataset 1", "cmu", "demo")
TOLERANCE = 0.01
"""A single change may be better than the chosen method by at most this."""

CHANGES: tuple[tuple[ModuleType, str, tuple[Any, ...]], ...] = (
    (fusion, "DTW_WEIGHT", (0.25, 0.5, 1.0)),
    (fusion, "DETOUR", (0.0, 0.5, 2.0)),
    (fusion, "NEIGHBORS", (0.5, 1.0)),
    (fusion, "ALIKE", (0.0, 0.5, 2.0)),
    (fusion, "SHORTLIST", (100, 200)),
    (diffusion, "REACH", (1.0, 3.0)),
    (motion_vector, "SLOW_SECONDS", (0.5, 2.0)),
    (motion_vector, "POSITION_WEIGHT", (0.5, 1.0)),
    (motion_vector, "MOVEMENT_WEIGHT", (0.0, 2.0)),
    (motion_vector, "DRIFT_WEIGHT", (0.0, 1.25)),
    (motion_vector, "TRAVEL_WEIGHTS", ((1.0, 1.0, 1.0), (3.0, 1.0, 1.0))),
    (motion_vector, "SWAY_WEIGHT", (0.0,)),
    (motion_vector, "TURN_SCALE", (0.1, 1.0)),
    (motion_vector, "COVARIANCE_SCALE", (0.0, 0.1)),
)


@dataclass(frozen=True)
class Figures:
    nearest: float
    at_4: float
    at_20: float
    mean_average_precision: float

    def as_text(self) -> str:
        shares = (self.nearest, self.at_4, self.at_20, self.mean_average_precision)
        return "".join(f"{share:8.3f}" for share in shares)


HEAD = "".join(f"{name:>8}" for name in ("1-NN", "P@4", "P@20", "MAP"))


@dataclass(frozen=True)
class Choice:
    """n clips for choices. sets, tasks: (n,); features: at 30 Hz; warped: (n, n) DTW distances."""

    sets: np.ndarray
    tasks: np.ndarray
    features: list[np.ndarray]
    warped: np.ndarray

    def vectors(self) -> np.ndarray:
        """The motion vectors by the current constants, (n, 128)."""
        return np.stack([motion_vector.motion_vector(one) for one in self.features]).astype(float)

    def judge(self, vectors: np.ndarray, rank: Callable[..., np.ndarray]) -> list[Figures]:
        """The figures of each set alone, then of all sets as one library."""
        parts = [np.flatnonzero(self.sets == name) for name in SETS]
        return [
            _figures([self._relevant(vectors, q, part, rank) for q in part])
            for part in (*parts, np.arange(len(self.tasks)))
        ]

    def _relevant(
        self, vectors: np.ndarray, query: int, part: np.ndarray, rank: Callable[..., np.ndarray]
    ) -> np.ndarray:
        others = part[part != query]
        near = np.linalg.norm(vectors[others] - vectors[query], axis=1)
        others = others[np.argsort(near, kind="stable")]
        head = others[: fusion.SHORTLIST]
        distances = rank(vectors[query], vectors[head], self.warped[query, head])
        order = np.concatenate([head[np.argsort(distances, kind="stable")], others[len(head) :]])
        return np.asarray(self.tasks[order] == self.tasks[query])


@pytest.fixture(scope="module")
def choice() -> Choice:
    found = list(_choice_clips())
    features = [one[2] for one in found]
    slow = [features_at_10hz(one, 30.0) for one in features]
    return Choice(
        np.array([one[0] for one in found]),
        np.array([one[1] for one in found]),
        features,
        np.stack([dtw_distances(query, slow) for query in slow]),
    )


def _choice_clips() -> Iterator[tuple[str, str, np.ndarray]]:
    """(set, task, frame features)."""
    for row in manifest():
        folder = row["path"].partition("/")[0]
        is_reported = folder == "bandai-namco-2" and row["person"] in REPORT_STYLES
        if is_reported or not row["path"].endswith(".bvh"):
            continue
        recording = read_recording((real_clips() / row["path"]).read_bytes())
        motion = canonicalize(recording, frame_rate=float(row["fps"]))
        name = "cmu" if folder.startswith("cmu") else f"dataset {folder[-1]}"
        yield name, row["task"], frame_features(body_track(motion))
    for clip in demo_clips():
        motion = canonicalize(read_recording(clip.content))
        yield "demo", clip.task, frame_features(body_track(motion))


def test_no_single_change_is_better_on_the_choice_sets(
    choice: Choice, monkeypatch: pytest.MonkeyPatch
) -> None:
    """MAP of each set alone and of all as one library. The mean of both counts."""
    FIGURES.print(
        "\n" + " " * 38 + "".join(f"{name:>11}" for name in SETS) + f"{'as one':>11}{'mean':>9}"
    )
    vectors = choice.vectors()

    def report(name: str, vectors: np.ndarray, rank: Callable[..., np.ndarray]) -> float:
        shares = [one.mean_average_precision for one in choice.judge(vectors, rank)]
        mean = float((np.mean(shares[:-1]) + shares[-1]) / 2)
        FIGURES.print(f"{name:38}" + "".join(f"{s:11.3f}" for s in shares) + f"{mean:9.4f}")
        return mean

    report("vector", vectors, lambda query, those, _: np.linalg.norm(those - query, axis=1))
    report("dtw", vectors, lambda _query, _those, warped: warped)
    chosen = report("fused, as chosen", vectors, fused_distances)
    best = chosen
    for module, name, values in CHANGES:
        for value in values:
            with monkeypatch.context() as changed:
                changed.setattr(module, name, value)
                other = choice.vectors() if module is motion_vector else vectors
                best = max(best, report(f"  {name} {value}", other, fused_distances))
    assert chosen > best - TOLERANCE


@pytest.fixture(scope="module")
def dataset_2(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """A library of the clips of dataset 2, imported and analyzed."""
    folder = tmp_path_factory.mktemp("retrieval")
    rows = [row for row in manifest() if row["path"].startswith("bandai-namco-2/")]
    _link(rows, folder / "clips")
    lib = Library.open(Settings(data_dir=folder / "data", refit_growth=1e9))
    job = imports.import_path(lib, folder / "clips")

    def is_over(_: Library) -> bool:
        return jobs.get_job(lib, job.id).finished_at is not None

    run_worker(lib.settings, threading.Event(), until=is_over)
    yield lib
    lib.close()


def _link(rows: list[dict[str, str]], folder: Path) -> None:
    """Make a folder with a manifest of these rows and links to their files."""
    for row in rows:
        target = folder / row["path"]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.symlink_to((real_clips() / row["path"]).resolve())
    with (folder / "manifest.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, rows[0].keys())
        table.writeheader()
        table.writerows(rows)


def test_the_default_keeps_its_figures_on_the_report_half(dataset_2: Library) -> None:
    """The report half does not reach the targets. The floors are asserted, all figures printed.

    Only four other clips of a task have the query's style (of 35), so P@20 needs takes of at least
    four other styles. The module's docstring lists the rejected changes. The first test here prints
    the effect of single changes: none is better by more than TOLERANCE. With labels, the task
    metric reaches .95 MAP on new styles (`test_learned_metrics.py`).
    """
    stored = _all_clips(dataset_2)
    reported = [clip for clip in stored if clip.person in REPORT_STYLES]
    others = [clip for clip in stored if clip.person not in REPORT_STYLES]
    found: dict[Method, Figures] = {}
    FIGURES.print(
        f"\nall {len(stored)} clips of dataset 2 are asked, load {os.getloadavg()[0]:.1f}"
    )
    FIGURES.print(
        f"{'':12}{f'report half, {len(reported)}':>32}{'':4}{f'choice half, {len(others)}':>32}"
    )
    FIGURES.print(f"{'':12}{HEAD}{'':4}{HEAD}{'ms':>8}")
    for method in [method for method in Method if method not in LEARNED]:
        took: list[float] = []
        half = [_ask(dataset_2, clip, method, len(stored), took) for clip in reported]
        rest = [_ask(dataset_2, clip, method, len(stored), took) for clip in others]
        found[method] = _figures(half)
        both = f"{found[method].as_text()}{'':4}{_figures(rest).as_text()}"
        FIGURES.print(f"{method:12}{both}{1e3 * np.median(took):8.1f}")
    reached = found[Method.FUSED]
    for name, target in TARGETS.items():
        FIGURES.print(f"{name}: {getattr(reached, name):.3f}, target {target:.3f}")
    for name, floor in FLOORS.items():
        assert getattr(reached, name) >= floor, name


def _ask(
    lib: Library, clip: ClipRecord, method: Method, count: int, took: list[float]
) -> np.ndarray:
    """Whether each hit is relevant, in the order of the ranking, (n - 1,)."""
    began = time.process_time()
    hits = find.find_motion(lib, MotionQuery(QuerySource(clip.id), method=method, limit=MAX_LIMIT))
    took.append(time.process_time() - began)
    assert len(hits.items) == count - 1
    return np.array([hit.clip.task == clip.task for hit in hits.items])


def _all_clips(lib: Library) -> list[ClipRecord]:
    first = clips.list_clips(lib, limit=1000)
    assert first.next is None
    assert {clip.state.value for clip in first.items} == {"ready"}
    return list(first.items)


def _figures(rows: list[np.ndarray]) -> Figures:
    """Means over the queries that have a relevant hit. rows: relevance of the hits, in order."""
    judged = [
        (
            row[0],
            row[:4].mean(),
            row[:20].mean(),
            average_precision(-np.arange(float(len(row))), row),
        )
        for row in rows
        if row.any()
    ]
    return Figures(*np.mean(judged, axis=0).tolist())
