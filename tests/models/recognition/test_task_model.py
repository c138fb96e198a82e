from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.recognition.task_model import (
    LINKS,
    Reading,
    fit_task_model,
    link_weights,
    objective,
)
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from tests.models.danced import danced_by


def test_weights_grow_with_the_links_to_the_centre() -> None:
    weights = dict(zip(SUN_ROLES, link_weights(), strict=True))
    assert sum(weights.values()) == pytest.approx(1.0)
    for role in SUN_ROLES:
        if role is not JointRole.HIPS:
            assert weights[role] > weights[role.toward_trunk()]
    assert set(LINKS) == set(SUN_ROLES)


def test_distances_are_those_of_the_joints_themselves_at_full_rank() -> None:
    """Slow twin: each joint of each probe that the training spans against each cell's."""
    danced = danced_by(3, 4, cycles=1)
    model = fit_task_model(danced.poses, danced.persons, danced.tasks)
    probes = danced.poses[[2, 5]] * 0.5 + danced.poses[[1, 0]] * 0.5
    found = model.joint_distances(probes)
    for n, probe in enumerate(probes):
        for cell, (p, t) in enumerate(zip(model.person, model.task, strict=True)):
            labels = (model.persons[p], model.tasks[t])
            own = list(zip(danced.persons, danced.tasks, strict=True)).index(labels)
            slow = np.square(probe - danced.poses[own]).sum(axis=(0, 2))
            np.testing.assert_allclose(found[n, cell], slow, atol=1e-9)


def test_the_objective_by_the_textbook() -> None:
    rng = np.random.default_rng(0)
    distances, label = rng.random((3, 6, 13)), np.array([2, 0, 1, 0, 2, 1])
    weights = link_weights()
    least = objective(distances, label, 3, weights, Reading.LEAST)
    printed = objective(distances, label, 3, weights, Reading.PRINTED)
    for n in range(3):
        minima = np.array([distances[n, label == k].min(axis=0) for k in range(3)])
        np.testing.assert_allclose(least[n], minima @ weights)
        for k in range(3):
            votes = [w * minima[k, i] for i, w in enumerate(weights) if minima[:, i].argmin() == k]
            assert printed[n, k] == pytest.approx(-sum(votes))


def test_missing_cells_are_never_compared_with_a_probe() -> None:
    danced = danced_by(3, 3, cycles=2)
    there = [p != "p1" or t != "t1" for p, t in zip(danced.persons, danced.tasks, strict=True)]
    part = danced.part(np.array(there))
    model = fit_task_model(part.poses, part.persons, part.tasks)
    assert (1, 1) not in set(zip(model.person.tolist(), model.task.tolist(), strict=True))
    assert model.joint_distances(danced.poses[:2]).shape == (2, 8, 13)


def test_ranks_can_be_reduced() -> None:
    danced = danced_by(4, 5, cycles=1)
    model = fit_task_model(danced.poses, danced.persons, danced.tasks, ranks=(6, 3, 4))
    assert model.svd.core.shape == (6, 3, 4)
    assert np.isfinite(model.joint_distances(danced.poses)).all()


def test_motions_without_labels_are_refused() -> None:
    with pytest.raises(NotEnoughLabels):
        fit_task_model(np.zeros((2, 4, 13, 3)), ["a", None], [None, "x"])
