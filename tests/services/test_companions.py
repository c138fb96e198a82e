"""Skeletons are found for motions by name, in the same folder first."""

from __future__ import annotations

import pytest

from app.services.companions import pair_skeletons


@pytest.mark.parametrize(
    ("motion", "skeletons", "wanted"),
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
def test_pairs(motion: str, skeletons: list[str], wanted: str | None) -> None:
    for paths in ([motion, *skeletons], [*skeletons, motion]):
        assert pair_skeletons(paths).get(motion) == wanted


def test_many_files_pair_in_no_time() -> None:
    paths = [f"{i}/{i}_{j}.amc" for i in range(300) for j in range(30)]
    paths += [f"{i}/{i}.asf" for i in range(300)]
    assert len(pair_skeletons(paths)) == 9000
