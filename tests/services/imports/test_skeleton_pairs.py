"""The skeleton of a motion is found by its name, first in the same folder."""

from __future__ import annotations

from pathlib import PurePosixPath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.services.imports.skeleton_pairs import pair_skeletons


@pytest.mark.parametrize(
    ("motion", "skeletons", "expected"),
    [
        ("07_01.amc", ["07.asf", "08.asf"], "07.asf"),
        ("07/07_01.AMC", ["08/08.asf", "07/07.ASF"], "07/07.ASF"),
        ("walk.amc", ["body.asf"], "body.asf"),
        ("walk.amc", ["a.asf", "b.asf"], None),
        ("walk.amc", ["walk.asf", "b.asf"], "walk.asf"),
        ("HDM_bd_01-02_03.amc", ["HDM.asf", "HDM_bd.asf", "HDM_b.asf"], "HDM_bd.asf"),
        ("07_01.amc", ["0.asf", "070.asf"], None),
        ("amc/07_01.amc", ["asf/07.asf", "asf/08.asf"], "asf/07.asf"),
        ("amc/walk.amc", ["asf/07.asf"], None),
        ("a/x/07_01.amc", ["a/07.asf", "b/07.asf"], "a/07.asf"),
        ("c/07_01.amc", ["a/07.asf", "b/07.asf"], None),
        ("a/07_01.amc", ["a/08.asf", "b/07.asf"], "a/08.asf"),
        ("07_01.bvh", ["07.asf"], None),
        ("07_01.amc", [], None),
    ],
)
def test_pairs(motion: str, skeletons: list[str], expected: str | None) -> None:
    for paths in ([motion, *skeletons], [*skeletons, motion]):
        assert pair_skeletons(paths).get(motion) == expected


def test_many_files_are_paired() -> None:
    paths = [f"{i}/{i}_{j}.amc" for i in range(300) for j in range(30)]
    paths += [f"{i}/{i}.asf" for i in range(300)]
    assert len(pair_skeletons(paths)) == 9000


def _naive_pair(motion: str, skeletons: list[str]) -> str | None:
    """A naive search of all skeletons, with the same rules."""

    def stem(path: str) -> str:
        return PurePosixPath(path).stem.lower()

    def shared(skeleton: str) -> int:
        ours, theirs = PurePosixPath(motion).parent.parts, PurePosixPath(skeleton).parent.parts
        count = 0
        while ours[: count + 1] == theirs[: count + 1] and count < min(len(ours), len(theirs)):
            count += 1
        return count

    whole = stem(motion)
    cuts = [whole[:i] for i in range(len(whole) - 1, 0, -1) if not whole[i].isalnum()]
    beside = [s for s in skeletons if PurePosixPath(s).parent == PurePosixPath(motion).parent]
    for group, is_only in ((beside, True), (skeletons, False)):
        for part in [whole, *cuts]:
            named = [skeleton for skeleton in group if stem(skeleton) == part]
            if named and is_only:
                return named[0]
            if named:
                nearest = [s for s in named if shared(s) == max(map(shared, named))]
                return nearest[0] if len(nearest) == 1 else None
        if is_only and len(beside) == 1:
            return beside[0]
    return None


_FOLDERS = st.lists(st.sampled_from("ab"), max_size=3).map(
    lambda parts: "".join(f"{p}/" for p in parts)
)
_STEMS = st.lists(st.sampled_from("xy"), min_size=1, max_size=3).map("_".join)


@given(_FOLDERS, _STEMS, st.lists(st.tuples(_FOLDERS, _STEMS), unique=True, max_size=8))
def test_the_pair_is_the_same_as_by_a_search_of_all_skeletons(
    folder: str, stem: str, others: list[tuple[str, str]]
) -> None:
    motion, skeletons = f"{folder}{stem}.amc", [f"{f}{s}.asf" for f, s in others]
    assert pair_skeletons([motion, *skeletons]).get(motion) == _naive_pair(motion, skeletons)


def test_very_many_skeletons_are_found_by_few_comparisons() -> None:
    stem = "_".join("ab" * 20)
    together = [f"d/s{i}.asf" for i in range(5000)] + [f"d/{stem}{i}.amc" for i in range(5000)]
    assert pair_skeletons(together) == {}
    apart = [f"d{i}/s.asf" for i in range(5000)] + [f"d{i}/x/s_{i}.amc" for i in range(5000)]
    assert len(pair_skeletons(apart)) == 5000
