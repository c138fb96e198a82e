"""Held-out figures of recognition on a library (Vasilescu 2002; Perera 2009, section 5).

If a part cannot be judged on the library, the result states the reason.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from statistics import median
from typing import TypeVar

from app.errors import NotEnoughLabels
from app.evaluate.grouping import Grouping, grouped
from app.evaluate.recognition.clips import JudgedClips, read_judged_clips, read_training
from app.evaluate.recognition.methods import (
    DEFAULT,
    METHODS,
    RANKING,
    SIGNATURES,
    Method,
    methods_at,
)
from app.evaluate.recognition.perera import judge_perera
from app.evaluate.recognition.results import (
    HeldOut,
    Judged,
    LabelGiven,
    RecognitionEvaluation,
    Seconds,
    SynthesisRows,
)
from app.evaluate.recognition.rounds import (
    LeftOut,
    Round,
    rounds,
    rounds_by_recording,
    rounds_by_takes,
)
from app.evaluate.recognition.shares import (
    Recognized,
    Unknown,
    chance,
    confusion,
    recognized,
    task_in_tree,
    unknown,
)
from app.evaluate.recognition.trials import Stopwatch, Trial, run, run_with_label
from app.services import fields
from app.services.library.library import Library
from app.services.training.synthesis_fit import fit_synthesis_on
from app.store.clips.filter import ClipFilter

FACTORS = ("person", "task")
TAKES = (3, 1)
"""Numbers of takes of each cell that the methods learn from."""
LABEL_GIVEN, MADE, PERERA = "told", "made", "perera"
"""Names of Vasilescu's and Perera's experiments in `not_judged`."""

Key = TypeVar("Key")
Found = TypeVar("Found")
Progress = Callable[[int, int], None]
"""Called after each step with the number of steps done and the total."""


def judge_recognition(
    lib: Library,
    filter: ClipFilter | None = None,
    methods: Sequence[str] = tuple(METHODS),
    *,
    false_accept_rate: float | None = None,
    by: str | None = None,
    progress: Progress | None = None,
) -> RecognitionEvaluation:
    """Judge each method on the ready clips that pass the filter.

    false_accept_rate: above 0 and below 1, for the methods default and perera; None: each uses
    its fitted threshold; by: shares for each group of clips too, see `Grouping`. Raises BadField
    for an unknown method or grouping or a wrong rate, and NotEnoughLabels if fewer than two clips
    have a label.
    """
    _check(methods, false_accept_rate)
    clips = read_judged_clips(lib, filter, Grouping.of(by))
    if len(clips) < 2:
        raise NotEnoughLabels("Two ready clips with a person or a task are needed to judge.")
    known = methods_at(false_accept_rate)
    found = judge_clips(clips, {name: known[name] for name in methods}, progress)
    reasons = dict(found.not_judged)
    perera = _or_reason(PERERA, reasons, lambda: judge_perera(lib, filter))
    made = _or_reason(MADE, reasons, lambda: _judge_made(lib, filter))
    return replace(found, perera=perera, made=made, not_judged=reasons)


def _judge_made(lib: Library, filter: ClipFilter | None) -> SynthesisRows:
    figures: SynthesisRows = fit_synthesis_on(lib.store, read_training(lib, filter))[1]["held_out"]
    return figures


def _or_reason(name: str, reasons: dict[str, str], judge: Callable[[], Found]) -> Found | None:
    """The result of `judge`; if it raises NotEnoughLabels, None, and the reason in `reasons`."""
    try:
        return judge()
    except NotEnoughLabels as reason:
        reasons[name] = reason.detail
        return None


def judge_clips(
    clips: JudgedClips, methods: Mapping[str, Method], progress: Progress | None = None
) -> RecognitionEvaluation:
    """As `judge_recognition`, for clips in memory. `not_judged` lists what cannot be judged."""
    reasons: dict[str, str] = {}

    def plan(name: str, found: Callable[[], list[Round]]) -> list[Round]:
        return _or_reason(name, reasons, found) or []

    held = {way: plan(way.value, partial(rounds, clips, way)) for way in LeftOut}
    takes = {n: plan(takes_key(n), partial(rounds_by_takes, clips, n)) for n in TAKES}
    by_recording = plan(LABEL_GIVEN, partial(rounds_by_recording, clips))
    all_rounds = (*held.values(), *takes.values(), by_recording)
    runner = _MethodRunner(
        clips, methods, sum(map(len, all_rounds)) * len(methods), progress, reasons
    )
    return RecognitionEvaluation(
        clips=clips,
        held_out=_without_empty({w: runner.held_out(w.value, found) for w, found in held.items()}),
        takes=_without_empty(
            {n: runner.held_out(takes_key(n), found) for n, found in takes.items()}
        ),
        label_given=runner.label_given(by_recording),
        seconds=runner.seconds(),
        not_judged=runner.reasons,
    )


def _without_empty(found: Mapping[Key, HeldOut]) -> dict[Key, HeldOut]:
    return {key: held for key, held in found.items() if held.methods}


def takes_key(takes: int) -> str:
    """The name in `not_judged` of the experiment with `takes` takes of each cell."""
    return f"{takes}-takes"


def _check(methods: Sequence[str], false_accept_rate: float | None) -> None:
    for name in methods:
        if name not in METHODS:
            raise fields.bad_field("method", f"must be one of {', '.join(METHODS)}")
    if false_accept_rate is not None and not 0 < false_accept_rate < 1:
        raise fields.bad_field("false_accept_rate", "must be above 0 and below 1")


class _MethodRunner:
    """Runs all methods and counts the steps."""

    def __init__(
        self,
        clips: JudgedClips,
        methods: Mapping[str, Method],
        steps: int,
        progress: Progress | None,
        reasons: dict[str, str],
    ) -> None:
        self._clips, self._methods, self._steps, self._progress = clips, methods, steps, progress
        self._watches = {name: Stopwatch() for name in methods}
        self._done = 0
        self.reasons = reasons

    def held_out(self, name: str, found: Sequence[Round]) -> HeldOut:
        trials: dict[str, tuple[Trial, ...]] = {}
        ranking_only = name not in set(_FACTOR_OF) | {LeftOut.SOURCE}
        for method, learn, watch in self._learners(ranking_only=ranking_only) if found else ():
            try:
                trials[method] = run(learn, self._clips_for(method), found, watch, self._step)
            except NotEnoughLabels as reason:
                self.reasons[f"{name}, {method}"] = reason.detail
        trials_of_first = next(iter(trials.values()), ())
        judged = tuple(_judged(method, some, name, self._clips) for method, some in trials.items())
        return HeldOut(len(found), judged, chance(trials_of_first))

    def label_given(self, found: Sequence[Round]) -> tuple[LabelGiven, ...]:
        judged = []
        for method, learn, watch in self._learners(ranking_only=True) if found else ():
            try:
                clips = self._clips_for(method)
                neither, given = run_with_label(learn, clips, found, watch, self._step)
            except NotEnoughLabels as reason:
                self.reasons[f"{LABEL_GIVEN}, {method}"] = reason.detail
            else:
                judged.append(LabelGiven(method, recognized(neither), recognized(given)))
        return tuple(judged)

    def _clips_for(self, method: str) -> JudgedClips:
        if method == DEFAULT:
            return self._clips.in_full()
        return self._clips.in_angles() if method == SIGNATURES else self._clips

    def _learners(self, *, ranking_only: bool) -> Iterator[tuple[str, Method, Stopwatch]]:
        """The methods.

        ranking_only: use the faster versions, which give only the best candidates; their time is
        not measured.
        """
        for name, method in self._methods.items():
            if ranking_only and name in RANKING:
                yield name, RANKING[name], Stopwatch()
            else:
                yield name, method, self._watches[name]

    def seconds(self) -> dict[str, Seconds]:
        return {
            name: Seconds(median(watch.fits), median(watch.probes))
            for name, watch in self._watches.items()
            if watch.probes
        }

    def _step(self) -> None:
        self._done += 1
        if self._progress is not None:
            self._progress(self._done, self._steps)


_FACTOR_OF: dict[str, str] = {LeftOut.PERSON: "person", LeftOut.TASK: "task"}
"""The factor whose labels are left out as a whole."""


def _judged(method: str, trials: Sequence[Trial], way: str, clips: JudgedClips) -> Judged:
    factor = _FACTOR_OF.get(way)
    of_new: list[Trial] = []
    if factor is not None:
        # a label that only the held-out takes carry is new too, but it was not left out
        trials = [t for t in trials if not t.of(factor).new or t.of(factor).truth in t.left_out]
        of_new = [t for t in trials if t.of(factor).new]
    return Judged(
        method=method,
        recognized=recognized(trials),
        of_new=recognized(of_new),
        unknown=_unknown(trials, way),
        confusion={name: confusion(trials, name) for name in FACTORS},
        by_name=_by_left_out(trials),
        by_group=_by_group(trials, clips.reported),
        task_in_tree=task_in_tree(trials, clips.tree),
    )


def _by_group(trials: Sequence[Trial], reported: Sequence[str] | None) -> dict[str, Recognized]:
    if reported is None:
        return {}
    parts = grouped([reported[trial.clip] for trial in trials], trials)
    return {group: recognized(part) for group, part in parts.items()}


def _unknown(trials: Sequence[Trial], way: str) -> dict[str, Unknown]:
    """The figures by factor, if whole labels of it, or whole sources, were left out."""
    factors = FACTORS if way == LeftOut.SOURCE else [_FACTOR_OF[way]] if way in _FACTOR_OF else []
    found = {name: unknown(trials, name) for name in factors}
    return {name: one for name, one in found.items() if one is not None}


def _by_left_out(trials: Sequence[Trial]) -> dict[str, Recognized]:
    """Shares by the labels that were left out, joined by commas."""
    groups = sorted({trial.left_out for trial in trials if trial.left_out})
    return {
        ", ".join(group): recognized([t for t in trials if t.left_out == group]) for group in groups
    }
