"""Query by example on real clips: relevant is the query's task, the query left out.

Run: pytest -m bench -s tests/bench/test_retrieval.py
The motion vector's parts and the graph of `fused` were chosen on dataset 1, CMU's clips, the
demo library and, of dataset 2, the queries of four styles (CHOICE); the other three styles'
queries were looked at when all was chosen, and are told apart. DESIGN 5's floors are those of
840 clips, which are not these.
"""

from __future__ import annotations

import csv
import os
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.analysis.analyse import describe_for_search
from app.config import Settings
from app.formats.read import read_recording
from app.models.ranking_figures import average_precision
from app.motion.canonical import canonicalise
from app.numerics.dtw import dtw_distances
from app.search import fusion
from app.search.methods import LEARNED, Method
from app.services import clips, find, imports, jobs
from app.services.demo import demo_clips
from app.services.find import MotionQuery
from app.services.library import Library
from app.store.clip_record import ClipRecord
from app.worker.loop import run_worker
from tests.real_clips import manifest, real_clips

pytestmark = pytest.mark.bench

FLOORS = {"vector": (0.99, 0.69), "dtw": (0.99, 0.58), "fused": (0.99, 0.70)}
"""(1-NN, MAP) of the queries that chose nothing."""
CHOICE = frozenset({"active", "exhausted", "masculine", "youthful"})
"""Styles of dataset 2 whose queries the choices saw."""
WEIGHTS = (0.0, 0.1, 0.25, 0.5, 1.0)
DETOURS = (0.0, 0.5, 1.0, 2.0)


@dataclass(frozen=True)
class Figures:
    nearest: float
    at_4: float
    at_20: float
    mean_average_precision: float

    def told(self) -> str:
        shares = (self.nearest, self.at_4, self.at_20, self.mean_average_precision)
        return "".join(f"{share:8.3f}" for share in shares)


HEAD = f"{'':14}{'1-NN':>8}{'P@4':>8}{'P@20':>8}{'MAP':>8}"


@pytest.fixture(scope="module")
def dataset_2(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """A library of the clips of dataset 2, imported and analysed."""
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
    """A folder with these rows' manifest and links to their files."""
    for row in rows:
        target = folder / row["path"]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.symlink_to((real_clips() / row["path"]).resolve())
    with (folder / "manifest.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, rows[0].keys())
        table.writeheader()
        table.writerows(rows)


def test_every_method_on_dataset_2(dataset_2: Library) -> None:
    stored = _all_clips(dataset_2)
    found: dict[str, Figures] = {}
    print(f"\n{len(stored)} clips of dataset 2, load {os.getloadavg()[0]:.1f}\n{HEAD}{'ms':>8}")
    for method in Method:
        if method in LEARNED:  # judged in test_learned_metrics, on clips that taught nothing
            continue
        rows: dict[bool, list[np.ndarray]] = {True: [], False: []}
        took = []
        for clip in stored:
            asked = MotionQuery(clip_id=clip.id, method=method, limit=find.MAX_LIMIT)
            began = time.process_time()
            hits = find.find_motion(dataset_2, asked)
            took.append(time.process_time() - began)
            assert len(hits.items) == len(stored) - 1
            is_relevant = np.array([hit.clip.task == clip.task for hit in hits.items])
            rows[clip.person in CHOICE].append(is_relevant)
        found[method.value] = _figures(rows[False])
        whole = _figures(rows[True] + rows[False])
        print(f"{method.value:14}{found[method.value].told()}{1e3 * np.median(took):8.1f}", end="")
        print(f"   all styles:{whole.told()}")
    for method_name, (nearest, average) in FLOORS.items():
        assert found[method_name].nearest >= nearest
        assert found[method_name].mean_average_precision >= average
    # What lies between is worth its time.
    assert found["fused"].mean_average_precision > found["vector"].mean_average_precision


def test_what_was_tried_of_fused_on_the_clips_that_chose(monkeypatch: pytest.MonkeyPatch) -> None:
    """MAP by weights of DTW and of the graph, on each set and on all as one library."""
    described = _described()
    sets = np.array([name for name, _, _ in described])
    tasks = np.array([task for _, task, _ in described])
    vectors = np.stack([arrays["motion_vector"] for _, _, arrays in described]).astype(float)
    features = [arrays["features_10hz"] for _, _, arrays in described]
    warped = np.stack([dtw_distances(query, features) for query in features])
    names = sorted(set(sets.tolist()))
    print(f"\n{'dtw graph':14}" + "".join(f"{name:>16}" for name in (*names, "as one")))
    best = {}
    for weight, detour in product(WEIGHTS, DETOURS):
        monkeypatch.setattr(fusion, "DTW_WEIGHT", weight)
        monkeypatch.setattr(fusion, "DETOUR", detour)
        members = [*(np.flatnonzero(sets == name) for name in names), np.arange(len(tasks))]
        found = [_fused_map(vectors, warped, tasks, one) for one in members]
        best[weight, detour] = float(np.mean(found))
        print(f"{weight:<6}{detour:<8}" + "".join(f"{share:16.4f}" for share in found))
    assert best[0.25, 1.0] > max(best.values()) - 0.02


def _fused_map(
    vectors: np.ndarray, warped: np.ndarray, tasks: np.ndarray, members: np.ndarray
) -> float:
    """MAP of `fused` in the library of `members`, its shortlist all of them."""
    rows = []
    for query in members:
        others = members[members != query]
        distances = fusion.fused_distances(vectors[query], vectors[others], warped[query, others])
        order = others[np.argsort(distances, kind="stable")]
        rows.append(tasks[order] == tasks[query])
    return _figures(rows).mean_average_precision


def _all_clips(lib: Library) -> list[ClipRecord]:
    first = clips.list_clips(lib, limit=1000)
    assert first.next is None
    assert {clip.state.value for clip in first.items} == {"ready"}
    return list(first.items)


def _figures(rows: list[np.ndarray]) -> Figures:
    """From each query's answers in order, whether each is relevant; all have a relevant one."""
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


def _described() -> list[tuple[str, str, dict[str, Any]]]:
    """(set, task, arrays) of the clips that the weight is chosen on."""
    found = []
    for row in manifest():
        folder = row["path"].partition("/")[0]
        if folder == "bandai-namco-2" or not row["path"].endswith(".bvh"):
            continue
        recording = read_recording((real_clips() / row["path"]).read_bytes())
        motion = canonicalise(recording, frame_rate=float(row["fps"]))
        name = "cmu" if folder.startswith("cmu") else folder
        found.append((name, row["task"], describe_for_search(motion).arrays))
    for clip in demo_clips():
        motion = canonicalise(read_recording(clip.content))
        found.append(("demo", clip.task, describe_for_search(motion).arrays))
    return found
