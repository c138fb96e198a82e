"""The recognition methods that an evaluation compares.

A method learns from clips and returns a judge. For each probe and factor (person, task), the judge
gives the best label, whether it is called known, and a novelty. The novelty is 0 at the threshold
of each fit and negative for known labels, so that the results of different fits fit on one curve.
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
    """label: the best candidate, None if there is none; known: whether the method calls the
    label known; novelty: a larger value means that the motion looks newer."""

    label: str | None
    known: bool
    novelty: float


NO_GUESS = Guess(None, False, 0.0)
"""The guess for a factor of which the training clips have no labels."""


class Judge(Protocol):
    """A fitted method."""

    def __call__(
        self, samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        """Guesses of person and task for each of `samples` (n, w), w as in the training.

        person, task: the label that is given for all of them, if any.
        """


Method = Callable[[Clips], Judge]
"""Fits a judge on clips. Raises NotEnoughLabels if the clips are too few."""


def default(clips: Clips, false_accept_rate: float | None = None) -> Judge:
    """The recognizer behind `POST /v1/recognize`, at this false-accept rate if one is given."""
    record = fit_recognizer(*clips)
    if false_accept_rate is not None:
        record = record.accepting(false_accept_rate)

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        return [_guesses(found) for found in recognize_many(record, samples, person, task)]

    return judge


def pca(clips: Clips) -> Judge:
    """Flat PCA, Vasilescu's baseline (section 5): nearest coefficients. It calls nothing new."""
    record = fit_flat_pca(clips.samples, clips.persons, clips.tasks)

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        return [_guesses(recognize_flat(record, one, person, task)) for one in samples]

    return judge


def perera(clips: Clips, false_accept_rate: float | None = None) -> Judge:
    """Perera's objective (eqs 13-14); eqs 15-16 with learned thresholds decide what is new."""
    record = fit_tensor_recognizer(clips.samples, clips.persons, clips.tasks, clips.groups)
    if false_accept_rate is not None:
        record = record.accepting(false_accept_rate)
    return _by_tensor(record)


def perera_ranking(clips: Clips) -> Judge:
    """The same best candidates as `perera` in a tenth of the time; it does not decide what is
    new."""
    return _by_tensor(uncalibrated(clips.samples, clips.persons, clips.tasks))


def _by_tensor(record: TensorRecognizer) -> Judge:
    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        return [_guesses(found) for found in recognize_by_tensor(record, samples, person, task)]

    return judge


def multilinear(clips: Clips, moments: int | None = None) -> Judge:
    """Vasilescu's model: signatures if the other factor is given, else the nearest cell.

    moments: number of poses at the start of each sample that are warped onto the mean of their
    task; None: no warping.
    """
    record = fit_multilinear(clips.samples, clips.persons, clips.tasks, moments=moments)
    cells = record.svd.reconstruct().reshape(-1, record.svd.factors[2].shape[0])

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        guessed = []
        for sample in samples:
            found = recognize_multilinear(record, sample, person, task)
            nearest = np.linalg.norm(cells - record.axes.project(sample), axis=1).min()
            beyond = float(nearest / max(record.radius, 1e-12)) - 1.0
            guessed.append((_guess(found.person, beyond), _guess(found.task, beyond)))
        return guessed

    return judge


RADIUS_SHARE = 95.0
"""Percentile of the distances of clips from the means of the other clips with their label; a
clip within that distance is near."""


def mean_motion(clips: Clips) -> Judge:
    """The baseline: a label is the mean of its motion samples, and the nearest mean wins.

    If the other factor is given, only clips with that label are averaged, if there are any. A
    clip is new if it lies beyond the radius (see RADIUS_SHARE) of every mean.
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
    """names: L labels; means: (L, d); radius: a clip farther from the nearest mean is new."""

    names: tuple[str, ...]
    means: FloatArray
    radius: float

    @classmethod
    def of(cls, samples: FloatArray, labels: Labels) -> _Means:
        names = tuple(sorted({label for label in labels if label}))
        members = [np.array([label == name for label in labels]) for name in names]
        means = np.array([samples[own].mean(axis=0) for own in members])
        apart = [
            # the mean that a clip is compared with must not contain the clip
            np.linalg.norm(samples[own] - mean, axis=1) * own.sum() / (own.sum() - 1)
            for own, mean in zip(members, means, strict=True)
            if own.sum() > 1
        ]
        radius = float(np.percentile(np.concatenate(apart), RADIUS_SHARE)) if apart else np.inf
        return cls(names, means, radius)

    def among(self, samples: FloatArray, labels: Labels) -> _Means:
        """The means of the clips with `labels`, with the same radius; self if none has one."""
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
    """The most frequent label, among the clips with the given label if there are any."""

    def judge(
        samples: FloatArray, person: str | None = None, task: str | None = None
    ) -> list[tuple[Guess, Guess]]:
        who = _most_frequent(clips.persons, clips.tasks, task)
        what = _most_frequent(clips.tasks, clips.persons, person)
        return [(who, what)] * len(samples)

    return judge


DEFAULT = "default"
SIGNATURES = "signatures"
"""The multilinear model on joint angles: its samples are angle samples."""

METHODS: Mapping[str, Method] = {
    DEFAULT: default,
    "multilinear": multilinear,
    SIGNATURES: partial(multilinear, moments=SAMPLES),
    "pca": pca,
    "perera": perera,
    "mean-motion": mean_motion,
    "prior": prior,
}
"""All methods by their public names."""

RANKING: Mapping[str, Method] = {"perera": perera_ranking}
"""Faster versions of some methods, for figures that need only the best candidates."""


def methods_at(false_accept_rate: float | None) -> dict[str, Method]:
    """All methods; the calibrated ones use this false-accept rate (0..1), if one is given."""
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


def _only(labels: Labels, others: Labels, given: str | None) -> Labels:
    """The labels of the clips whose other label is the given one, None for the other clips."""
    if given is None:
        return [None] * len(labels)
    return [a if b == given else None for a, b in zip(labels, others, strict=True)]


def _most_frequent(labels: Labels, others: Labels, given: str | None) -> Guess:
    """The most frequent label. It is always called known, since a prior cannot see novelty."""
    for among in (_only(labels, others, given), labels):
        names = Counter(sorted(label for label in among if label))
        if names:
            return Guess(names.most_common(1)[0][0], True, -1.0)
    return NO_GUESS
