"""Trials: each pairs the answer of a method on an unseen clip with the true labels."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from app.errors import NotEnoughLabels
from app.evaluate.recognition.clips import JudgedClips
from app.evaluate.recognition.methods import Guess, Judge, Method
from app.evaluate.recognition.rounds import Round
from app.models.held_out.recognition import Clips
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class FactorResult:
    """The answer of a method on one factor (person or task) of a probe.

    truth: the true label, None if unknown; new: whether the method has not seen that label;
    guess: its answer; labels: the number of labels that it knows.
    """

    truth: str | None
    new: bool
    guess: Guess
    labels: int

    @property
    def right(self) -> bool:
        """Whether the best candidate is the true label. Calling it new makes no difference."""
        return self.guess.label == self.truth


@dataclass(frozen=True, slots=True)
class Trial:
    """One probe: the index of a clip, and the labels or sources that were left out.

    together: whether the training clips have the same person at the same task, and not only
    each of the two elsewhere.
    """

    clip: int
    left_out: tuple[str, ...]
    person: FactorResult
    task: FactorResult
    together: bool

    def of(self, factor: str) -> FactorResult:
        """The result for the factor "person" or "task"."""
        return self.person if factor == "person" else self.task


@dataclass(slots=True)
class Stopwatch:
    """Seconds of each fit, and of each probe."""

    fits: list[float] = field(default_factory=list)
    probes: list[float] = field(default_factory=list)


def run(
    method: Method,
    clips: JudgedClips,
    rounds: Iterable[Round],
    watch: Stopwatch,
    step: Callable[[], None] = lambda: None,
) -> tuple[Trial, ...]:
    """Fit and probe in each round; rounds with too few labels for the method are left out.

    `step` is called after each round. Raises NotEnoughLabels if no round is left.
    """
    trials: list[Trial] = []
    reason = None
    for one in rounds:
        train = clips.part(one.train)
        try:
            start = time.perf_counter()
            judge = method(train)
            watch.fits.append(time.perf_counter() - start)
        except NotEnoughLabels as too_few:
            reason = too_few
        else:
            start = time.perf_counter()
            guesses = judge(clips.samples[one.probe])
            watch.probes.append((time.perf_counter() - start) / len(one.probe))
            trials += _trials(clips, one, train, one.probe, guesses)
        step()
    if not trials and reason is not None:
        raise reason
    return tuple(trials)


def run_with_label(
    method: Method,
    clips: JudgedClips,
    rounds: Iterable[Round],
    watch: Stopwatch,
    step: Callable[[], None] = lambda: None,
) -> tuple[tuple[Trial, ...], tuple[Trial, ...]]:
    """Trials without any label given, and trials where the other label is given.

    In the second, the method recognizes the person knowing the task, and the task knowing the
    person (Vasilescu 2002, section 5). All probes have both labels; probes with a label that
    the method has not seen are left out. Raises NotEnoughLabels if no probe is left.
    """
    neither: list[Trial] = []
    either: list[Trial] = []
    for one in rounds:
        train = clips.part(one.train)
        known = [i for i in one.probe.tolist() if _is_known(clips, i, train)]
        judge = _fitted(method, train, watch) if known else None
        if judge is not None:
            guesses = judge(clips.samples[known])
            neither += _trials(clips, one, train, known, guesses)
            who = _judge_with_label(judge, clips, known, "task")
            what = _judge_with_label(judge, clips, known, "person")
            guesses = [(who[i][0], what[i][1]) for i in known]
            either += _trials(clips, one, train, known, guesses)
        step()
    if not neither:
        raise NotEnoughLabels("No recording has a person and a task that others have too.")
    return tuple(neither), tuple(either)


def _fitted(method: Method, train: Clips, watch: Stopwatch) -> Judge | None:
    """The fitted method, None if these clips are too few for it."""
    start = time.perf_counter()
    try:
        judge = method(train)
    except NotEnoughLabels:
        return None
    watch.fits.append(time.perf_counter() - start)
    return judge


def _is_known(clips: JudgedClips, i: int, train: Clips) -> bool:
    return clips.persons[i] in train.persons and clips.tasks[i] in train.tasks


def _judge_with_label(
    judge: Judge, clips: JudgedClips, probes: Sequence[int], given: str
) -> dict[int, tuple[Guess, Guess]]:
    """The answers by clip when its label of the factor `given` is known."""
    labels = clips.labels(given)
    found: dict[int, tuple[Guess, Guess]] = {}
    for name in sorted({labels[i] or "" for i in probes}):
        some = [i for i in probes if labels[i] == name]
        samples: FloatArray = clips.samples[some]
        guesses = judge(samples, task=name) if given == "task" else judge(samples, person=name)
        found |= dict(zip(some, guesses, strict=True))
    return found


def _trials(
    clips: JudgedClips,
    one: Round,
    train: Clips,
    probes: Sequence[int] | IntArray,
    guesses: Sequence[tuple[Guess, Guess]],
) -> list[Trial]:
    persons, tasks = ({label for label in labels if label} for labels in train[1:3])
    cells = set(zip(train.persons, train.tasks, strict=True))
    return [
        Trial(
            clip=i,
            left_out=one.left_out,
            person=_result(clips.persons[i], persons, who),
            task=_result(clips.tasks[i], tasks, what),
            together=(clips.persons[i], clips.tasks[i]) in cells,
        )
        for i, (who, what) in zip(np.asarray(probes).tolist(), guesses, strict=True)
    ]


def _result(truth: str | None, seen: set[str], guess: Guess) -> FactorResult:
    return FactorResult(truth or None, truth not in seen, guess, len(seen))
