"""All recognition methods on clips of invented persons and tasks."""

from __future__ import annotations

import numpy as np
import pytest

from app.evaluate.recognition.methods import METHODS, NO_GUESS, RANKING, methods_at
from app.models.held_out.recognition import Clips
from tests.evaluate.recognition.recognition_library import LENGTH, invented

CLIPS = invented(persons=4, tasks=5, takes=3)
PART = CLIPS.part(np.arange(len(CLIPS)))


@pytest.mark.parametrize("name", METHODS)
def test_known_means_below_zero(name: str) -> None:
    judge = METHODS[name](PART)
    rng = np.random.default_rng(0)
    strange = np.concatenate([CLIPS.samples[::7], 3 * rng.normal(size=(6, LENGTH))])
    for guesses in judge(strange):
        for guess in guesses:
            assert guess.known == (guess.novelty <= 0)


@pytest.mark.parametrize("name", METHODS)
def test_learning_twice_gives_the_same_guesses(name: str) -> None:
    assert METHODS[name](PART)(CLIPS.samples) == METHODS[name](PART)(CLIPS.samples)


@pytest.mark.parametrize("name", [name for name in METHODS if name not in ("pca", "prior")])
def test_a_distant_sample_has_a_larger_novelty(name: str) -> None:
    judge = METHODS[name](PART)
    near, far = judge(np.stack([CLIPS.samples[0], CLIPS.samples[0] + 20.0]))
    assert far[1].novelty > near[1].novelty
    assert near[1].known
    assert not far[1].known


def test_the_mean_motion_is_the_nearest_mean() -> None:
    judge = METHODS["mean-motion"](PART)
    for factor, labels in ((0, CLIPS.persons), (1, CLIPS.tasks)):
        names = sorted(set(labels))  # type: ignore[type-var]
        means = [CLIPS.samples[[label == name for label in labels]].mean(axis=0) for name in names]
        for sample, guesses in zip(CLIPS.samples, judge(CLIPS.samples), strict=True):
            nearest = names[int(np.argmin([((sample - mean) ** 2).sum() for mean in means]))]
            assert guesses[factor].label == nearest


def test_a_given_person_helps_the_mean_motion() -> None:
    judge = METHODS["mean-motion"](PART)
    for i, (who, what) in enumerate(zip(CLIPS.persons, CLIPS.tasks, strict=True)):
        sample = CLIPS.samples[i : i + 1]
        assert judge(sample, task=what)[0][0].label == who
        assert judge(sample, person=who)[0][1].label == what
    unheard = judge(CLIPS.samples[:1], task="unheard of")
    assert unheard[0][0] == judge(CLIPS.samples[:1])[0][0]


def test_the_prior_is_the_most_frequent() -> None:
    clips = Clips(np.zeros((4, LENGTH)), ["a", "b", "b", "a"], ["x", "y", "y", "y"], list("1234"))
    judge = METHODS["prior"](clips)
    assert [guess.label for guess in judge(np.zeros((1, LENGTH)))[0]] == ["a", "y"]
    assert judge(np.zeros((1, LENGTH)), task="y")[0][0].label == "b"
    assert judge(np.zeros((1, LENGTH)), person="a")[0][1].label == "x"


@pytest.mark.parametrize("name", ["default", "mean-motion", "prior"])
def test_a_factor_without_labels_has_no_guess(name: str) -> None:
    clips = Clips(CLIPS.samples, [None] * len(CLIPS), CLIPS.tasks, CLIPS.groups)
    ((person, task),) = METHODS[name](clips)(CLIPS.samples[:1])
    assert person == NO_GUESS
    assert task.label in CLIPS.tasks


@pytest.mark.parametrize("name", RANKING)
def test_the_faster_version_gives_the_same_best_candidates(name: str) -> None:
    part = CLIPS.part(np.arange(0, len(CLIPS), 2))
    best = [
        [[guess.label for guess in guesses] for guesses in way[name](part)(CLIPS.samples)]
        for way in (METHODS, RANKING)
    ]
    assert best[0] == best[1]


def test_a_lower_rate_accepts_less() -> None:
    clips = invented(persons=4, tasks=6, takes=3)
    new = np.array([task == "t0" for task in clips.tasks])
    part = clips.part(np.flatnonzero(~new))
    accepted = [
        sum(task.known for _, task in methods_at(rate)["default"](part)(clips.samples[new]))
        for rate in (0.0, 0.9)
    ]
    assert accepted[0] < accepted[1]
