"""Parts of the body: their columns, and the summaries of poses."""

from __future__ import annotations

import numpy as np
import pytest

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.search.composed.body_parts import (
    JOINTS,
    BodyPart,
    PoseSummaries,
    feature_columns,
    summary,
    summary_columns,
)
from app.search.index import rows as index_rows
from app.search.index.rows import Rows
from app.search.pose.by_pose import POSES
from tests.search.indexed import indexed


@pytest.mark.parametrize("part", list(BodyPart))
def test_columns_are_those_of_the_joints(part: BodyPart) -> None:
    named = [SUN_ROLES[joint] for joint in JOINTS[part]]
    assert JointRole.HIPS not in named
    expected = [3 * joint + axis for joint in JOINTS[part] for axis in range(3)]
    expected += [39 + one for one in expected]
    assert sorted(feature_columns(part).tolist()) == sorted(expected)
    roles = [role for role in SUN_ROLES if role is not JointRole.HIPS]
    means = [3 * roles.index(role) + axis for role in named for axis in range(3)]
    assert summary_columns(part).tolist() == [*means, *(36 + one for one in means)]


def test_summaries_are_those_of_each_clip(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(index_rows, "BLOCK", 8)
    rng = np.random.default_rng(2)
    covers = {f"clip_{n}": rng.normal(size=(3 + 5 * n, 38)).astype(np.float32) for n in range(5)}
    rows = Rows(POSES)
    rows.put([indexed(name, cover) for name, cover in covers.items()])
    kept = PoseSummaries()
    found = kept.of(1, rows.view())
    naive = np.stack([summary(cover) for cover in covers.values()])
    np.testing.assert_allclose(found, naive, atol=1e-5)
    assert kept.of(1, rows.view()) is found
    rows.remove(["clip_0"])
    rows.put([indexed("clip_9", covers["clip_1"])])
    again = kept.of(2, rows.view())
    np.testing.assert_allclose(again[-1], naive[1], atol=1e-5)


def test_an_empty_index_has_no_summaries() -> None:
    assert PoseSummaries().of(0, Rows(POSES).view()).shape == (0, 72)
