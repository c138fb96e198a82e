from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.factor_model import FactorModel, fit_factor_model
from app.models.multilinear import fit_multilinear
from app.numerics.arrays import BoolArray, FloatArray
from tests.models.factor_clips import factor_clips

WIDTH = 60
SHAPE = (3, 4, 3, 3)


class Clips:
    """Samples of persons, tasks and styles, whose effects add up, three takes each."""

    def __init__(self) -> None:
        rng = np.random.default_rng(0)
        index = np.indices(SHAPE).reshape(4, -1)
        effects = [
            s * rng.normal(size=(n, WIDTH)) for s, n in zip((0.5, 1, 0.4), SHAPE, strict=False)
        ]
        summed = sum(effect[at] for effect, at in zip(effects, index, strict=False))
        self.samples: FloatArray = 1.0 + summed + 0.03 * rng.normal(size=(index.shape[1], WIDTH))
        self.take = index[3]
        self.factors = {
            name: [f"{name}{i}" for i in at]
            for name, at in zip(("person", "task", "style"), index, strict=False)
        }

    def fit(self, chosen: BoolArray) -> FactorModel:
        rows = np.flatnonzero(chosen)
        factors = {name: [labels[i] for i in rows] for name, labels in self.factors.items()}
        return fit_factor_model(self.samples[rows], factors)

    def truth(self, row: int) -> dict[str, str]:
        return {name: labels[row] for name, labels in self.factors.items()}


@pytest.fixture(scope="module")
def clips() -> Clips:
    return Clips()


def test_three_factors_are_recognised_with_and_without_the_others(clips: Clips) -> None:
    model = clips.fit(clips.take > 0)
    for row in np.flatnonzero(clips.take == 0)[::4]:
        truth = clips.truth(int(row))
        found = model.recognise(clips.samples[row])
        assert {name: answer.label for name, answer in found.items()} == truth
        for name in truth:
            others = {other: label for other, label in truth.items() if other != name}
            assert model.recognise(clips.samples[row], others)[name].label == truth[name]


def test_a_combination_nobody_recorded_is_made_and_recognised(clips: Clips) -> None:
    pairs = zip(*clips.factors.values(), strict=True)
    missing = np.array([row == ("person1", "task2", "style0") for row in pairs])
    model = clips.fit(~missing)
    assert len(model.recorded) == 3 * 4 * 3 - 1
    truth = clips.samples[missing].mean(axis=0)
    made = model.motion({"person": "person1", "task": "task2", "style": "style0"})
    assert np.linalg.norm(made - truth) < 0.3 * np.linalg.norm(truth - clips.samples.mean(axis=0))
    found = model.recognise(clips.samples[missing][0])
    assert found["task"].label == "task2"


def test_recorded_combinations_are_reproduced(clips: Clips) -> None:
    model = clips.fit(clips.take == 0)
    row = int(np.flatnonzero(clips.take == 0)[7])
    np.testing.assert_allclose(model.motion(clips.truth(row)), clips.samples[row], atol=1e-8)
    eigenmotions = model.eigenmotions()
    np.testing.assert_allclose(
        eigenmotions.T @ eigenmotions, np.eye(eigenmotions.shape[1]), atol=1e-9
    )


def test_two_factors_are_the_multilinear_model() -> None:
    clips = factor_clips()
    model = fit_factor_model(clips.samples, {"person": clips.persons, "task": clips.tasks})
    twin = fit_multilinear(clips.samples, clips.persons, clips.tasks)
    for ours, theirs in zip(model.svd.factors, twin.svd.factors, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-8)
    np.testing.assert_allclose(model.eigenmotions(), twin.eigenmotions(), atol=1e-8)
    ours = model.parameters(clips.samples[5], "person", {"task": "t2"})
    np.testing.assert_allclose(ours, twin.signature(clips.samples[5], "t2"), atol=1e-8)


def test_ranks_can_be_reduced_and_unknown_labels_tell_nothing(clips: Clips) -> None:
    model = fit_factor_model(clips.samples, clips.factors, {"person": 2, "style": 2})
    assert model.svd.core.shape[:3] == (2, 4, 2)
    plain = model.recognise(clips.samples[0])
    assert model.recognise(clips.samples[0], {"person": "nobody"}) == plain


def test_one_factor_is_refused() -> None:
    with pytest.raises(NotEnoughLabels, match="two factors"):
        fit_factor_model(np.eye(3), {"person": ["a", "b", "a"], "task": ["x", "x", "x"]})
