"""Search by example for styles and persons that the library lacks.

Run: pytest -m bench -s tests/bench/test_unseen_styles.py
All clips of the query's own style (person) in its own source are left out. The first row leaves out
the query alone: its style is then no stranger. A clip is relevant if it has the query's task. In
the columns "or a kind of it", a clip is relevant also if one label is above the other in the tree
of labels that Kinedex builds without help of people (a dash is a run).

"unseen": the six styles of dataset 1 that dataset 2 lacks. The weights of `fused` were chosen on
clips of the same three sources, of which these queries are a part: the figures are no result on new
sources.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
import pytest

from app.models.held_out.ranking import average_precision
from app.models.words.language.label_tree import LabelTree, label_tree
from app.search.example.methods import Method
from tests.bench.described_clips import RealClips, described_clips
from tests.bench.disturbed_clips import drawn, share
from tests.bench.page import Section
from tests.search.local_index import LocalLibrary

FIGURES = Section(
    "unseen_styles",
    "Styles and persons that the library lacks",
    trials="each row says how many queries; 1-NN with Wilson's interval, 95 %",
    chance="printed as `chance`: the share of relevant clips, averaged over the queries",
)

pytestmark = pytest.mark.bench

METHODS = (Method.FUSED, Method.VECTOR, Method.DTW)
OWN_STYLE_TOO = "unseen, own style among all"
UNSEEN = ("angry", "childish", "happy", "old", "sad", "tired")
FIRST, SECOND = "bandai-namco-1", "bandai-namco-2"
MAX_QUERIES = 100
SHOWN_ERRORS = 12


@dataclass(frozen=True)
class Judged:
    """One query by one method. is_right, is_kind: of the nearest clip; tasks: its own, and that."""

    is_right: bool
    is_kind: bool
    precision: float
    kind_precision: float
    chance: float
    tasks: tuple[str, str]


def test_styles_that_the_library_lacks() -> None:
    clips = described_clips()
    judge = Judge(
        clips,
        LocalLibrary({str(i): arrays for i, arrays in enumerate(clips.arrays)}),
        label_tree(set(clips.tasks.tolist()), {}),
    )
    first, second = clips.folders == FIRST, clips.folders == SECOND
    cmu = np.char.startswith(clips.folders, "cmu")
    unseen = first & np.isin(clips.persons, UNSEEN)
    everything = np.ones(len(clips), dtype=bool)
    trials = {
        OWN_STYLE_TOO: (unseen, everything),
        "unseen, among all": (unseen, everything),
        "unseen, among other sources": (unseen, ~first),
        "dataset 1, among all": (first, everything),
        "dataset 2, among itself": (second, second),
        "dataset 2, among all": (second, everything),
        "CMU, among all": (cmu, everything),
    }
    FIGURES.print(f"{'':30}{'':8}{'':>5}  {'1-NN':26}{'MAP':>7}{'1-NN':>12}{'MAP':>7}{'chance':>8}")
    FIGURES.print(f"{'':30}{'':38}{'':8}{'or a kind of it':>18}")
    for name, (asks, among) in trials.items():
        queries = np.flatnonzero(asks)
        if len(queries) > MAX_QUERIES:
            queries = np.sort(drawn(queries, MAX_QUERIES))
        for method in METHODS:
            found = [judge.one(query, name, among, method) for query in queries.tolist()]
            _print(name, method, [one for one in found if one is not None])


@dataclass(frozen=True)
class Judge:
    """Ranks the clips and counts those with the query's task."""

    clips: RealClips
    library: LocalLibrary
    tree: LabelTree

    def one(self, query: int, trial: str, among: np.ndarray, method: Method) -> Judged | None:
        """None if no clip that may be found has the task. among: (n,) clips that may be found."""
        clips, task = self.clips, str(self.clips.tasks[query])
        own = np.arange(len(clips)) == query
        if trial != OWN_STYLE_TOO:
            own = (clips.persons == clips.persons[query]) & (clips.folders == clips.folders[query])
        excluded = frozenset(map(str, np.flatnonzero(own | ~among)))
        order = self.library.rank(clips.arrays[query], method, exclude=excluded).ids
        tasks = clips.tasks[order.astype(int)]
        same = tasks == task
        if not same.any():
            return None
        kin = same | np.isin(tasks, self._kinds(task, set(tasks.tolist())))
        places = -np.arange(float(len(tasks)))
        return Judged(
            bool(same[0]),
            bool(kin[0]),
            average_precision(places, same),
            average_precision(places, kin),
            float(same.mean()),
            (task, str(tasks[0])),
        )

    def _kinds(self, task: str, tasks: set[str]) -> list[str]:
        is_kind = self.tree.is_kind
        return [one for one in tasks if is_kind(one, task) or is_kind(task, one)]


def _print(name: str, method: Method, judged: list[Judged]) -> None:
    precision, kind_precision, chance, kinds = (
        float(np.mean([getattr(one, field) for one in judged]))
        for field in ("precision", "kind_precision", "chance", "is_kind")
    )
    right = share([one.is_right for one in judged])
    FIGURES.print(
        f"{name:30}{method:8}{len(judged):>5}  {right:26}{precision:7.3f}"
        f"{kinds:12.3f}{kind_precision:7.3f}{chance:8.3f}"
    )
    if method is Method.FUSED:
        errors = Counter(one.tasks for one in judged if not one.is_right)
        shown = [f"{own} -> {other} {n}" for (own, other), n in errors.most_common(SHOWN_ERRORS)]
        FIGURES.print(f"    nearest of another task: {', '.join(shown) or 'none'}")
