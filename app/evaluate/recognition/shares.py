"""Computes figures from trials: shares recognized, confusion matrices, how well new labels show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from app.evaluate.recognition.trials import FactorResult, Trial
from app.models.words.language.label_tree import LabelTree
from app.numerics.area_under_curve import area_under_curve
from app.numerics.arrays import FloatArray
from app.numerics.binomial import wilson_interval

CURVE_POINTS = 101
"""The number of points of a curve of false acceptance and false rejection."""


@dataclass(frozen=True, slots=True)
class Share:
    """A share of trials: `right` of `of`."""

    right: int
    of: int

    @property
    def value(self) -> float | None:
        """The share, 0..1; None without trials."""
        return self.right / self.of if self.of else None

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % confidence interval of the share (Wilson)."""
        return wilson_interval(self.right, self.of)

    @classmethod
    def that(cls, hits: Iterable[bool]) -> Share:
        """The share of `hits` that are true."""
        every = list(hits)
        return cls(sum(every), len(every))


@dataclass(frozen=True, slots=True)
class Recognized:
    """Shares of clips whose best candidate is right.

    person, task: of the clips whose label the method has seen; both: of the clips whose person
    and task it has both seen.
    """

    person: Share
    task: Share
    both: Share


@dataclass(frozen=True, slots=True)
class Category:
    """The figures of one label that was left out of the training.

    refused: its clips that were called new; accepted: the known clips of the same rounds that
    were called known; taken_for: the most frequent answer for its clips that were called
    known.
    """

    label: str
    refused: Share
    accepted: Share
    taken_for: str | None

    @property
    def balanced_accuracy(self) -> float | None:
        """The mean of both shares; None without trials."""
        values = self.refused.value, self.accepted.value
        return None if None in values else sum(filter(None, values)) / 2


@dataclass(frozen=True, slots=True)
class Unknown:
    """How well a method separates labels that it has not seen from labels that it has.

    refused: new clips that were called new; accepted: known clips that were called known;
    accepted_together: the same for known clips whose person the method has seen do the
    same task;
    area_under_curve: the chance that a new clip has a larger novelty than a known one;
    categories: the figures of each label that was left out; curve: (P, 2) false acceptance and
    false rejection at P thresholds.
    """

    refused: Share
    accepted: Share
    accepted_together: Share
    area_under_curve: float
    categories: tuple[Category, ...]
    curve: FloatArray

    @property
    def false_acceptance(self) -> float:
        """The share of new clips that were called known."""
        return 1.0 - (self.refused.value or 0.0)

    @property
    def false_rejection(self) -> float:
        """The share of known clips that were called new."""
        return 1.0 - (self.accepted.value or 0.0)

    @property
    def balanced_accuracy(self) -> float:
        """The mean of the shares of right answers for new and known clips; 0.5 is chance."""
        return 1.0 - (self.false_acceptance + self.false_rejection) / 2

    @property
    def equal_error_rate(self) -> float:
        """The error at the threshold where false acceptance and false rejection are equal."""
        index = int(np.argmin(np.abs(self.curve[:, 0] - self.curve[:, 1])))
        return float(self.curve[index].mean())

    @property
    def worst(self) -> Category | None:
        """The label with the smallest balanced accuracy."""
        judged = [one for one in self.categories if one.balanced_accuracy is not None]
        return min(judged, key=lambda one: one.balanced_accuracy or 0.0, default=None)


def recognized(trials: Iterable[Trial]) -> Recognized:
    """The shares of right best candidates, of the trials with a label that the method has seen."""
    judged = list(trials)
    both = [t for t in judged if _is_judged(t.person) and _is_judged(t.task)]
    return Recognized(
        person=Share.that(t.person.right for t in judged if _is_judged(t.person)),
        task=Share.that(t.task.right for t in judged if _is_judged(t.task)),
        both=Share.that(t.person.right and t.task.right for t in both),
    )


def chance(trials: Iterable[Trial]) -> tuple[float | None, float | None, float | None]:
    """The shares of person, task and both that guessing would reach; None without trials."""
    judged = list(trials)
    person = [1 / t.person.labels for t in judged if _is_judged(t.person)]
    task = [1 / t.task.labels for t in judged if _is_judged(t.task)]
    both = [
        1 / (t.person.labels * t.task.labels)
        for t in judged
        if _is_judged(t.person) and _is_judged(t.task)
    ]
    return _mean(person), _mean(task), _mean(both)


def unknown(trials: Sequence[Trial], factor: str) -> Unknown | None:
    """The figures for new labels of the factor "person" or "task".

    None unless there are both new and known clips.
    """
    pairs = [(trial, trial.of(factor)) for trial in trials if trial.of(factor).truth]
    new = [result for _, result in pairs if result.new]
    known = [result for _, result in pairs if not result.new]
    if not new or not known:
        return None
    together = [result for trial, result in pairs if not result.new and trial.together]
    known_novelty, new_novelty = _novelty(known), _novelty(new)
    return Unknown(
        refused=_refused(new),
        accepted=_accepted(known),
        accepted_together=_accepted(together),
        area_under_curve=area_under_curve(new_novelty, known_novelty),
        categories=_categories(pairs),
        curve=_curve(known_novelty, new_novelty),
    )


def confusion(trials: Iterable[Trial], factor: str) -> tuple[tuple[str, ...], FloatArray]:
    """The confusion matrix of the factor "person" or "task".

    Returns C labels, sorted, and (C, C) shares: a row for each true label, a column for the label
    that was answered. Only clips whose label had been seen count. The row of a label that was
    answered but never true is 0.
    """
    judged = [result for result in (trial.of(factor) for trial in trials) if _is_judged(result)]
    pairs = [
        (result.truth or "", result.guess.label or "") for result in judged if result.guess.label
    ]
    names = tuple(sorted({name for pair in pairs for name in pair}))
    counts = np.zeros((len(names), len(names)))
    for truth, guess in pairs:
        counts[names.index(truth), names.index(guess)] += 1
    return names, counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)


def task_in_tree(trials: Iterable[Trial], tree: LabelTree) -> float | None:
    """The mean likeness (`LabelTree.likeness`) of the answered tasks to the true ones, 0..1.

    Without any kinds it is the share of right tasks. Only clips whose task had been seen count;
    None without one.
    """
    judged = [trial.task for trial in trials if _is_judged(trial.task)]
    return _mean([tree.likeness(one.truth or "", one.guess.label or "") for one in judged])


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _is_judged(result: FactorResult) -> bool:
    return result.truth is not None and not result.new


def _refused(new: Iterable[FactorResult]) -> Share:
    return Share.that(not result.guess.known for result in new)


def _accepted(known: Iterable[FactorResult]) -> Share:
    return Share.that(result.guess.known for result in known)


def _categories(pairs: Sequence[tuple[Trial, FactorResult]]) -> tuple[Category, ...]:
    """A category for each label that was left out, by name; pairs: trials and their answers."""
    names = sorted({result.truth or "" for _, result in pairs if result.new})
    return tuple(_category(name, pairs) for name in names)


def _category(name: str, pairs: Sequence[tuple[Trial, FactorResult]]) -> Category:
    own = [(trial, result) for trial, result in pairs if result.new and result.truth == name]
    rounds = {trial.left_out for trial, _ in own}
    known = [result for trial, result in pairs if not result.new and trial.left_out in rounds]
    answers = [result for _, result in own]
    return Category(name, _refused(answers), _accepted(known), _most_frequent_answer(answers))


def _most_frequent_answer(new: Iterable[FactorResult]) -> str | None:
    """The most frequent answer for new clips that were called known; the first one of equals."""
    labels = sorted(result.guess.label or "" for result in new if result.guess.known)
    return Counter(labels).most_common(1)[0][0] if labels else None


def _novelty(some: Iterable[FactorResult]) -> FloatArray:
    """(n,) the novelty of each answer."""
    return np.array([result.guess.novelty for result in some])


def _curve(known: FloatArray, new: FloatArray) -> FloatArray:
    """(P, 2) false acceptance and false rejection at P rising thresholds of novelty.

    known, new: (n,) and (m,) novelties.
    """
    every = np.unique(np.concatenate([known, new]))
    cuts = np.concatenate([[every[0] - 1.0], every])
    indices = np.unique(np.linspace(0, len(cuts) - 1, CURVE_POINTS).round().astype(int))
    accepted = np.searchsorted(np.sort(new), cuts[indices], side="right") / len(new)
    rejected = 1 - np.searchsorted(np.sort(known), cuts[indices], side="right") / len(known)
    return np.stack([accepted, rejected], axis=1)
