"""Searches by several parts on real clips: what each part more brings, beside the parts alone.

Run: pytest -m bench -s tests/bench/test_composed.py
489 clips: both data sets of Bandai Namco, and the BVH files of CMU. A random half has no words, as
if nobody had labeled it; only clips of this half are hits of a query with a word. The curves of
`app/search/composed/likeness.py` were chosen on trials on the same clips, drawn with another seed:
the figures say how the parts compare, not how other clips would do.
"""

from __future__ import annotations

import csv
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import pytest

from app.config import Settings
from app.models.held_out.ranking import average_precision
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.find.by_parts import find_by_parts
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query_source import QuerySource
from app.services.imports import imports
from app.services.library.library import Library
from app.services.training.fit import fit_library
from app.worker.loop import run_worker
from tests.bench.page import Section
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "composed",
    "Searches by several parts",
    trials="200 of each kind, drawn at random (printed where fewer remain)",
    chance="the share of relevant clips, printed with each kind",
)

pytestmark = pytest.mark.bench

FOLDERS = ("bandai-namco-1", "bandai-namco-2", "cmu-bvh")
TRIALS = 200
FIRST = 10
MIN_CLIPS = 8
"""Tasks with fewer clips are no query."""


@dataclass(frozen=True)
class Clips:
    """n clips of a library. ids, tasks, persons: (n,) texts; unlabeled: (n,) the half without."""

    lib: Library
    ids: np.ndarray
    tasks: np.ndarray
    persons: np.ndarray
    unlabeled: np.ndarray

    def relevance(
        self,
        relevant: np.ndarray,
        likes: tuple[int, ...] = (),
        against: tuple[int, ...] = (),
        words: tuple[str, ...] = (),
        among: np.ndarray | None = None,
        drop: tuple[int, ...] = (),
    ) -> np.ndarray:
        """Whether each hit is relevant, in order; hits that are not `among`, or in `drop`, go."""
        examples = [
            Example(f"examples.{place}", QuerySource(self.ids[row]), is_against=row in against)
            for place, row in enumerate((*likes, *against))
        ]
        query = ComposedQuery(examples, words, limit=1000, clip_fields=frozenset())
        place_of = {clip_id: row for row, clip_id in enumerate(self.ids)}
        rows = [place_of[hit.clip.id] for hit in find_by_parts(self.lib, query).items]
        kept = [row for row in rows if (among is None or among[row]) and row not in drop]
        return np.asarray(relevant[kept])

    def queries(self, rng: np.random.Generator) -> Iterator[int]:
        """Clips of frequent tasks; every task is as likely."""
        frequent = sorted(t for t, count in Counter(self.tasks).items() if count >= MIN_CLIPS)
        while True:
            task = frequent[rng.integers(len(frequent))]
            yield int(rng.choice(np.flatnonzero(self.tasks == task)))


class Table:
    """Rows of P@10, or P@R for few relevant clips, and MAP."""

    def __init__(self) -> None:
        self._rows: dict[str, list[tuple[float, float]]] = {}

    def add(self, name: str, relevance: np.ndarray, first: int = FIRST) -> None:
        share = float(relevance[:first].sum() / first)
        self._rows.setdefault(name, []).append(
            (share, average_precision(-np.arange(len(relevance)), relevance))
        )

    def show(self, title: str, chance: float) -> dict[str, float]:
        """The first column by row."""
        FIGURES.print(f"\n{title} (chance {chance:.3f})")
        for name, values in self._rows.items():
            share, precision = np.mean(values, axis=0)
            FIGURES.print(f"  {name:34}{share:8.3f}{precision:8.3f}   {len(values)} trials")
        return {name: float(np.mean(values, axis=0)[0]) for name, values in self._rows.items()}


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Clips]:
    folder = tmp_path_factory.mktemp("composed")
    rng = np.random.default_rng(0)
    rows = [row for row in manifest() if row["path"].startswith(FOLDERS)]
    hidden = {row["path"]: bool(rng.random() < 0.5) for row in rows}
    given = [{**row, "words": "" if hidden[row["path"]] else row["words"]} for row in rows]
    for row in given:
        target = folder / "clips" / row["path"]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.symlink_to((real_clips() / row["path"]).resolve())
    with (folder / "clips" / "manifest.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, given[0].keys())
        table.writeheader()
        table.writerows(given)
    lib = Library.open(Settings(data_dir=folder / "data", refit_growth=1e9))
    job = imports.import_path(lib, folder / "clips")
    run_worker(
        lib.settings,
        threading.Event(),
        until=lambda _: jobs.get_job(lib, job.id).finished_at is not None,
    )
    fit_library(lib.store)
    yield _clips(lib, hidden)
    lib.close()


def _clips(lib: Library, hidden: dict[str, bool]) -> Clips:
    found = [
        clip for clip in clips.list_clips(lib, limit=1000).items if clip.state.value == "ready"
    ]

    def column(read: Callable[..., object]) -> np.ndarray:
        return np.array([read(clip) for clip in found], dtype=object)

    return Clips(
        lib,
        column(lambda clip: clip.id),
        column(lambda clip: clip.task),
        column(lambda clip: clip.person),
        np.array([hidden[str(clip.path)] for clip in found]),
    )


def test_two_examples_of_a_task_by_different_persons_find_it_better_than_one(real: Clips) -> None:
    table, shares, rng = Table(), [], np.random.default_rng(1)
    for one in real.queries(rng):
        relevant = real.tasks == real.tasks[one]
        others = np.flatnonzero(relevant & (real.persons != real.persons[one]))
        if not len(others):
            continue
        both = one, int(rng.choice(others))
        for row in both:
            table.add("one example", real.relevance(relevant, (row,), drop=both))
        table.add("both", real.relevance(relevant, both))
        shares.append(relevant.mean())
        if len(shares) == TRIALS:
            break
    title = "The task of two examples by different persons: P@10, MAP"
    found = table.show(title, float(np.mean(shares)))
    assert found["both"] > found["one example"]


def test_a_word_narrows_an_example(real: Clips) -> None:
    """The clips of the example's task, in another style, which is the word."""
    table, shares, rng = Table(), [], np.random.default_rng(2)
    words = {word for row in manifest() for word in row["words"].split()}
    styles = sorted({person for person in real.persons if person in words})
    for one in real.queries(rng):
        style = str(rng.choice(styles))
        relevant = real.unlabeled & (real.tasks == real.tasks[one]) & (real.persons == style)
        relevant[one] = False
        if style == real.persons[one] or relevant.sum() < 2:
            continue
        first, among = int(relevant.sum()), real.unlabeled
        asked: dict[str, tuple[tuple[int, ...], tuple[str, ...]]] = {
            "the example": ((one,), ()),
            "the word": ((), (style,)),
            "the example and the word": ((one,), (style,)),
        }
        for name, (likes, texts) in asked.items():
            found = real.relevance(relevant, likes, words=texts, among=among, drop=(one,))
            table.add(name, found, first)
        shares.append(relevant.sum() / among.sum())
        if len(shares) == TRIALS:
            break
    title = "The task of an example in the style of a word: P@R, MAP"
    means = table.show(title, float(np.mean(shares)))
    together = means.pop("the example and the word")
    assert together > 2 * max(means.values())


def test_a_wrong_hit_that_is_marked_as_less_like_this_makes_room(real: Clips) -> None:
    """The example against is the first hit of another task."""
    table, shares, rng = Table(), [], np.random.default_rng(3)
    for drawn, one in enumerate(real.queries(rng)):
        if drawn == TRIALS:
            break
        relevant = real.tasks == real.tasks[one]
        query = ComposedQuery([Example("examples.0", QuerySource(real.ids[one]))], limit=20)
        hits = [hit.clip.id for hit in find_by_parts(real.lib, query).items]
        wrong = [int(np.flatnonzero(real.ids == clip_id)[0]) for clip_id in hits]
        wrong = [row for row in wrong if not relevant[row]]
        if not wrong:
            continue
        table.add("the example", real.relevance(relevant, (one,), drop=(wrong[0],)))
        table.add("less like its first wrong hit", real.relevance(relevant, (one,), (wrong[0],)))
        shares.append(relevant.mean())
    title = "The task of an example with wrong hits among 20: P@10, MAP"
    found = table.show(title, float(np.mean(shares)))
    assert found["less like its first wrong hit"] > found["the example"]


def test_the_time_grows_with_the_examples_alone(real: Clips) -> None:
    rng = np.random.default_rng(4)
    for count in (2, 5, 20):
        rows = rng.choice(len(real.ids), size=count, replace=False)
        examples = [
            Example(f"examples.{place}", QuerySource(real.ids[row]))
            for place, row in enumerate(rows)
        ]
        query = ComposedQuery(examples, ("wave",))
        find_by_parts(real.lib, query)
        began = time.process_time()
        find_by_parts(real.lib, query)
        took = time.process_time() - began
        FIGURES.print(f"\n{count} examples and a word: {1e3 * took:.0f} ms of processor time")
        assert took < 3.0
