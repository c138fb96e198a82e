"""CPU time of searches by several parts among many clips, in one process without HTTP.

Run: pytest -m bench -s tests/bench/test_composed_latency.py
The store has real clips with noise on their vectors, as in `test_latency.py`; words are left out,
since `test_words_at_scale.py` measures them. Each search names other stored clips. CPU time is
printed, not the clock, because the machine may be busy (target of issue 21: p95 of 100 ms at
100,000 clips). BENCH_CLIPS=10000 chooses another number.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.config import Settings
from app.search.composed.body_parts import BodyPart
from app.services.find.arrangement import Arrangement, GroupBy
from app.services.find.by_parts import find_by_parts
from app.services.find.queries import ComposedQuery, Example, PoseQuery, PoseSequence, Rhythm
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from tests.bench.large_library import fill
from tests.bench.page import Section
from tests.bench.test_latency import NAMES

FIGURES = Section(
    "composed_latency",
    "CPU time of searches by several parts",
    trials="40 searches of each kind, after one that is not measured",
)

pytestmark = pytest.mark.bench

COUNT = int(os.environ.get("BENCH_CLIPS", "100000"))
TRIALS = 40
TREE = {"any_of": [{"task": "walk"}, {"none_of": [{"person": ["person 7", "person 8"]}]}]}
ASKED: dict[str, dict[str, Any]] = {
    "two examples": {"examples": 2},
    "two examples, tree of filters": {"examples": 2, "filter": {"where": TREE}},
    "two examples, grouped by person": {"examples": 2, "group": GroupBy.PERSON},
    "two examples, diverse": {"examples": 2, "diversity": 0.5},
    "two examples, six facets": {
        "examples": 2,
        "facets": ("person", "task", "source", "license", "word", "speed"),
    },
    "legs": {"examples": 1, "body_part": BodyPart.LEGS},
    "from one pose to another": {"poses": 2},
    "rhythm": {"rhythm": 55.0},
    "an example, legs, two poses": {"examples": 1, "body_part": BodyPart.LEGS, "poses": 2},
}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    settings = Settings(data_dir=tmp_path_factory.mktemp("composed") / "data")
    lib = Library.open(settings)
    fill(lib.store, COUNT, names=NAMES)
    yield lib
    lib.close()
    for file in Path(settings.data_dir).glob("kinedex.sqlite3*"):
        file.unlink()


def _query(rng: np.random.Generator, asked: dict[str, Any]) -> ComposedQuery:
    def source() -> QuerySource:
        return QuerySource(f"clip_{rng.integers(COUNT):020x}")

    examples = [
        Example(f"examples.{place}", source(), body_part=asked.get("body_part"))
        for place in range(asked.get("examples", 0))
    ]
    poses = [PoseQuery(source(), 0.5) for _ in range(asked.get("poses", 0))]
    return ComposedQuery(
        examples=examples,
        poses=PoseSequence(poses) if poses else None,
        rhythm=Rhythm(asked["rhythm"]) if "rhythm" in asked else None,
        filter=asked.get("filter"),
        arrangement=Arrangement(asked.get("group"), None, asked.get("diversity", 0.0)),
        facets=asked.get("facets", ()),
    )


def test_cpu_time(library: Library) -> None:
    rng = np.random.default_rng(1)
    FIGURES.print(f"\n{COUNT} clips, CPU ms{'':20}p50     p95")
    for name, asked in ASKED.items():
        _show(name, lambda asked=asked: find_by_parts(library, _query(rng, asked)))


def _show(name: str, search: Any) -> None:
    spent = []
    for _ in range(TRIALS + 1):
        before = time.process_time()
        search()
        spent.append(1e3 * (time.process_time() - before))
    FIGURES.print(
        f"  {name:32}" + "".join(f"{ms:8.1f}" for ms in np.percentile(spent[1:], [50, 95]))
    )
