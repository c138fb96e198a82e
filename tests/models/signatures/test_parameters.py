from __future__ import annotations

import numpy as np
import pytest

from app.models.recognition.multilinear import Multilinear, fit_multilinear
from app.models.signatures.clips import clip_parameters
from app.models.signatures.eigenmotions import eigenmotions
from app.models.signatures.parameters import Parameters, person_parameters, task_parameters
from tests.models.factor_clips import FactorClips, factor_clips


@pytest.fixture(scope="module")
def clips() -> FactorClips:
    return factor_clips(takes=1, noise=0.0)


@pytest.fixture(scope="module")
def model(clips: FactorClips) -> Multilinear:
    return fit_multilinear(clips.samples, clips.persons, clips.tasks)


def distances(rows: np.ndarray) -> np.ndarray:
    return np.linalg.norm(rows[:, None] - rows[None], axis=-1)


def test_weighted_parameters_are_as_far_apart_as_the_motions(
    clips: FactorClips, model: Multilinear
) -> None:
    tensor = clips.samples.reshape(5, 6, -1)
    for found, rows in (
        (person_parameters(model), tensor.reshape(5, -1)),
        (task_parameters(model), tensor.transpose(1, 0, 2).reshape(6, -1)),
    ):
        weighted = found.vectors * found.singular_values
        np.testing.assert_allclose(distances(weighted), distances(rows), atol=1e-9)


def test_points_are_the_best_plane_of_the_persons(model: Multilinear) -> None:
    found = person_parameters(model)
    weighted = found.vectors * found.singular_values
    centered = weighted - weighted.mean(axis=0)
    lengths = np.linalg.svd(centered, compute_uv=False)
    assert found.kept == pytest.approx((lengths[:2] ** 2).sum() / (lengths**2).sum())
    points = found.points(found.vectors)
    np.testing.assert_allclose((points**2).sum(axis=0), lengths[:2] ** 2)


def test_two_persons_are_shown_on_a_line() -> None:
    few = factor_clips(persons=2, takes=1)
    found: Parameters = person_parameters(fit_multilinear(few.samples, few.persons, few.tasks))
    assert found.kept == pytest.approx(1.0)
    points = found.points(found.vectors)
    assert points.shape == (2, 2)
    np.testing.assert_allclose(points[:, 1], 0.0, atol=1e-9)


def test_eigenmotions_add_up_to_the_motions(clips: FactorClips, model: Multilinear) -> None:
    found = eigenmotions(model)
    weights = found.weights(clips.samples)
    np.testing.assert_allclose(weights @ found.vectors, clips.samples, atol=1e-9)
    np.testing.assert_allclose(found.mean, clips.samples.mean(axis=0), atol=1e-9)
    np.testing.assert_allclose(found.deviations, weights.std(axis=0), atol=1e-9)
    assert found.shares.sum() == pytest.approx(1.0)
    moved = found.along(1, 2.0) - found.along(1, 0.0)
    np.testing.assert_allclose(moved, 2 * found.deviations[1] * found.vectors[1], atol=1e-9)


def test_the_clips_of_a_cell_have_its_parameters(clips: FactorClips, model: Multilinear) -> None:
    people, actions, _ = model.svd.factors
    persons = [*clips.persons[:8], "nobody", clips.persons[9]]
    tasks = [*clips.tasks[:8], clips.tasks[8], None]
    found = clip_parameters(model, eigenmotions(model), clips.samples[:10], persons, tasks)
    for who, what, own in zip(persons[:8], tasks[:8], found, strict=False):
        assert own.signature is not None
        assert own.action is not None
        np.testing.assert_allclose(own.signature, people[model.persons.index(who)], atol=1e-6)
        np.testing.assert_allclose(own.action, actions[model.tasks.index(what)], atol=1e-6)
    assert found[8].action is None
    assert found[8].signature is not None
    assert found[9].signature is None
    assert found[9].action is not None
