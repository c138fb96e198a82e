"""The ways of telling who does what that are judged side by side.

A method learns from clips and makes a judge, which tells of a probe the best label of each
factor, whether it calls it known, and how new it looks. Novelty is 0 at the threshold of
each fit, below where it is called known, so that different fits can be put on one curve.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.models.held_out.recognition import Clips
from app.models.recognition.answers import Answer, Recognition
from app.models.recognition.flat_pca import fit_flat_pca, recognize_flat
from app.models.recognition.multilinear import fit_multilinear, recognize_multilinear
from app.models.recognition.perera import (
    TensorRecognizer,
    fit_tensor_recognizer,
    recognize_by_tensor,
    uncalibrated,
)
from app.models.recognition.recognizer import fit_recognizer, recognize_many
from app.numerics.arrays import FloatArray

Labels = Sequence[str | None]


@dataclass(frozen=True, slots=True)
class Guess:
    """label: the best candidate, None without any; known: whether it is called so; novelty:
    the higher, the newer it looks."""

    label: str | None
    known: bool
    novelty: float


NO_GUESS = Guess(None, False, 0.0)
"""Of a factor that the clips learned from have no labels of."""


class Judge(Protocol):
    """What a method has learned."""

    def __call__(
        self, samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        """Person and task of each of `samples` (n, width of what was learned from), which share
        what is told of them."""


Method = Callable[[Clips], Judge]
"""Raises NotEnoughLabels where the clips are too few for it."""


def default(clips: Clips, false_accept_rate: float | None = None) -> Judge:
    """The recognizer that `POST /v1/recognize` asks, at this rate where one is given."""
    record = fit_recognizer(*clips)
    if false_accept_rate is not None:
        record = record.accepting(false_accept_rate)

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        return [_guesses(found) for found in recognize_many(record, samples, person, task)]

    return judge


def pca(clips: Clips) -> Judge:
    """Flat PCA, Vasilescu's baseline (section 5): nearest coefficients. All is known to it."""
    record = fit_flat_pca(clips.samples, clips.persons, clips.tasks)

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        return [_guesses(recognize_flat(record, one, person, task)) for one in samples]

    return judge


def perera(clips: Clips, false_accept_rate: float | None = None) -> Judge:
    """Perera's objective (eqs 13-14), and what is new by eqs 15-16 with learned thresholds."""
    record = fit_tensor_recognizer(*clips)
    if false_accept_rate is not None:
        record = record.accepting(false_accept_rate)
    return _by_tensor(record)


def perera_ranking(clips: Clips) -> Judge:
    """The same best candidates, without what is new, in a tenth of the time."""
    return _by_tensor(uncalibrated(clips.samples, clips.persons, clips.tasks))


def _by_tensor(record: TensorRecognizer) -> Judge:
    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        return [_guesses(found) for found in recognize_by_tensor(record, samples, person, task)]

    return judge


def multilinear(clips: Clips, moments: int | None = None) -> Judge:
    """Vasilescu's: signatures where the other factor is told, else the nearest cell.

    moments: poses with which a sample begins, where they are to be warped onto their task's.
    """
    record = fit_multilinear(clips.samples, clips.persons, clips.tasks, moments=moments)
    cells = record.svd.reconstruct().reshape(-1, record.svd.factors[2].shape[0])

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        told = []
        for sample in samples:
            found = recognize_multilinear(record, sample, person, task)
            nearest = np.linalg.norm(cells - record.axes.project(sample), axis=1).min()
            beyond = float(nearest / max(record.radius, 1e-12)) - 1.0
            told.append((_guess(found.person, beyond), _guess(found.task, beyond)))
        return told

    return judge


RADIUS_SHARE = 95.0
"""Percentile of the distances of clips to the means of their fellows that counts as near."""


def mean_motion(clips: Clips) -> Judge:
    """The baseline: a label is the mean of its motion samples, and the nearest mean wins.

    Where the other factor is told, only clips with that are averaged, if there are some. New
    is what lies further from every mean than all but 5 % of the clips from their fellows'.
    """
    people, tasks = (_Means.of(clips.samples, labels) for labels in (clips.persons, clips.tasks))

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        who = people.among(clips.samples, _only(clips.persons, clips.tasks, task))
        what = tasks.among(clips.samples, _only(clips.tasks, clips.persons, person))
        return list(zip(who.nearest(samples), what.nearest(samples), strict=True))

    return judge


@dataclass(frozen=True, slots=True)
class _Means:
    """names: L labels; means: (L, d); radius: distance from the nearest beyond which is new."""

    names: tuple[str, ...]
    means: FloatArray
    radius: float

    @classmethod
    def of(cls, samples: FloatArray, labels: Labels) -> _Means:
        names = tuple(sorted({label for label in labels if label}))
        members = [np.array([label == name for label in labels]) for name in names]
        means = np.array([samples[own].mean(axis=0) for own in members])
        apart = [
            # a clip's own share is taken out of the mean that it is held against
            np.linalg.norm(samples[own] - mean, axis=1) * own.sum() / (own.sum() - 1)
            for own, mean in zip(members, means, strict=True)
            if own.sum() > 1
        ]
        radius = float(np.percentile(np.concatenate(apart), RADIUS_SHARE)) if apart else np.inf
        return cls(names, means, radius)

    def among(self, samples: FloatArray, labels: Labels) -> _Means:
        """The means of these clips alone, as near as before; all where none has a label."""
        found = _Means.of(samples, labels)
        return replace(found, radius=self.radius) if found.names else self

    def nearest(self, samples: FloatArray) -> list[Guess]:
        if not self.names:
            return [NO_GUESS] * len(samples)
        return [self._guess(np.linalg.norm(self.means - one, axis=1)) for one in samples]

    def _guess(self, distances: FloatArray) -> Guess:
        nearest = int(np.argmin(distances))
        beyond = float(distances[nearest] - self.radius) if np.isfinite(self.radius) else -1.0
        return Guess(self.names[nearest], beyond <= 0, beyond)


def prior(clips: Clips) -> Judge:
    """The most frequent label, of the clips with the told one where there are some."""

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        who = _most_frequent(clips.persons, clips.tasks, task)
        what = _most_frequent(clips.tasks, clips.persons, person)
        return [(who, what)] * len(samples)

    return judge


DEFAULT = "default"
SIGNATURES = "signatures"
"""The multilinear model on joint angles: it is given angle samples instead of motion samples."""

METHODS: Mapping[str, Method] = {
    DEFAULT: default,
    "multilinear": multilinear,
    SIGNATURES: partial(multilinear, moments=SAMPLES),
    "pca": pca,
    "perera": perera,
    "mean-motion": mean_motion,
    "prior": prior,
}
"""By the name that they are asked for and shown by."""

RANKING: Mapping[str, Method] = {"perera": perera_ranking}
"""Of those that are much quicker where nobody asks what is new."""


def methods_at(false_accept_rate: float | None) -> dict[str, Method]:
    """All methods; the calibrated ones call new things known at this rate at most, if given."""
    at_rate = {
        DEFAULT: partial(default, false_accept_rate=false_accept_rate),
        "perera": partial(perera, false_accept_rate=false_accept_rate),
    }
    return {**METHODS, **at_rate}


def _guesses(found: Recognition) -> tuple[Guess, Guess]:
    return _guess(found.person, found.person.novelty), _guess(found.task, found.task.novelty)


def _guess(answer: Answer, novelty: float) -> Guess:
    if not answer.candidates:
        return NO_GUESS
    return Guess(answer.candidates[0].label, answer.known, novelty)


def _only(labels: Labels, others: Labels, told: str | None) -> Labels:
    """The labels of clips whose other label is the told one; of the rest none."""
    if told is None:
        return [None] * len(labels)
    return [a if b == told else None for a, b in zip(labels, others, strict=True)]


def _most_frequent(labels: Labels, others: Labels, told: str | None) -> Guess:
    """Called known whatever it is: a prior has no idea of what is new."""
    for among in (_only(labels, others, told), labels):
        names = Counter(sorted(label for label in among if label))
        if names:
            return Guess(names.most_common(1)[0][0], True, -1.0)
    return NO_GUESS
