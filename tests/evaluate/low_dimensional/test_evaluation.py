"""The comparison of keyposes with uniform poses, and its pictures."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest

from app.analysis.low_dimensional.eigen_motion import Basis
from app.errors import NotEnoughKeyposes
from app.evaluate import LowDimensionalEvaluation, judge_low_dimensional
from app.evaluate.low_dimensional.pictures import all_figures
from app.services.library.library import Library
from app.services.views.low_dimensional import Reduction, reduce, view
from app.store.clips.filter import ClipFilter
from tests.libraries import FindClip


@pytest.fixture(scope="module")
def found(ready_library: Library) -> LowDimensionalEvaluation:
    return judge_low_dimensional(ready_library)


def test_the_table_is_the_mean_of_the_clips(ready_library: Library, clip_of: FindClip) -> None:
    waves = ClipFilter(task=("wave",))
    steps: list[tuple[int, int]] = []
    found = judge_low_dimensional(ready_library, waves, lambda *step: steps.append(step))
    clips = [clip_of(person, "wave") for person in ("ada", "bruno", "chika")]
    assert (found.clips, found.left_out) == (3, 0)
    assert steps == [(1, 3), (2, 3), (3, 3)]
    for row in found.dimensions[:4]:
        for basis in Basis:
            drawn = [reduce(ready_library, c, Reduction(row.dimensions, basis)) for c in clips]
            at = row.dimensions - 1
            assert row.clips == 3
            assert row.variance[basis] == pytest.approx(
                np.mean([one.variance_kept[at] for one in drawn])
            )
            assert row.error[basis] == pytest.approx(1000 * np.mean([o.errors[at] for o in drawn]))


def test_the_axes_of_all_frames_have_the_smallest_error(found: LowDimensionalEvaluation) -> None:
    for row in found.dimensions:
        assert row.best <= min(row.error.values())
        assert 0 <= row.keypose_better <= 1
    errors = [row.error["uniform"] for row in found.dimensions if row.clips == found.clips]
    assert errors == sorted(errors, reverse=True)


def test_poses_have_the_same_faults_as_in_the_view(
    ready_library: Library, found: LowDimensionalEvaluation, clip_of: FindClip
) -> None:
    waves = judge_low_dimensional(ready_library, ClipFilter(task=("wave",), person=("ada",)))
    rows = {row.name: row for row in waves.poses}
    shown = view(ready_library, clip_of("ada", "wave").id, Reduction(3))
    assert rows["original"].implausible == shown.original_plausibility.count
    assert rows["keypose"].implausible == shown.plausibility.count
    assert {row.frames for row in waves.poses} == {len(shown.plausibility.implausible)}
    assert sum(rows["keypose"].faults.values()) >= rows["keypose"].implausible
    assert 0 <= found.more_clustered <= 1


def test_persons_of_a_task_make_one_model(
    ready_library: Library, found: LowDimensionalEvaluation, clip_of: FindClip
) -> None:
    (wave,) = (group for group in found.groups if group.task == "wave")
    ids = [clip_of(person, "wave").id for person in ("ada", "bruno", "chika")]
    joint = view(ready_library, ids[0], Reduction(3, model_clips=ids)).reduced
    assert (wave.persons, wave.poses) == (3, joint.model.poses)
    assert wave.variance["keypose"] == pytest.approx(joint.variance_kept[2])
    errors = [view(ready_library, i, Reduction(3, model_clips=ids)).reduced.errors[2] for i in ids]
    assert 1000 * min(errors) <= wave.error["keypose"] <= 1000 * max(errors)
    alone = judge_low_dimensional(ready_library, ClipFilter(person=("ada",)))
    assert alone.groups == ()


def test_a_library_without_keyposes_is_refused(ready_library: Library) -> None:
    with pytest.raises(NotEnoughKeyposes, match="No ready clip has 4 keyposes; 0 were looked at"):
        judge_low_dimensional(ready_library, ClipFilter(task=("sleep",)))


def test_every_figure_is_drawn(found: LowDimensionalEvaluation) -> None:
    drawn = all_figures(found, "svg")
    assert {
        "variance-and-error.svg", "eigen-keyposes.svg", "eigen-uniform-poses.svg",
        "eigen-motion.svg", "dimensions.svg",
    } <= set(drawn)  # fmt: skip
    for content in drawn.values():
        ElementTree.fromstring(content)
    assert b">4 dimensions<" in drawn["dimensions.svg"]
    assert b">original<" in drawn["dimensions.svg"]
