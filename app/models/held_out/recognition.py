"""Held-out figures of recognition: persons and tasks on clips that the models have not seen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.errors import NotEnoughLabels
from app.models.folds import grouped_folds
from app.models.holding_out import FOLDS, MIN_LABELS
from app.models.recognition.answers import NO_ANSWER, Answer, Recognition, given
from app.models.recognition.copies import ClipCopies
from app.models.recognition.flat_pca import fit_flat_pca, recognize_flat
from app.models.recognition.multilinear import fit_multilinear, recognize_multilinear
from app.models.recognition.perera import TensorRecognizer, recognize_by_tensor, uncalibrated
from app.models.recognition.recognizer import Recognizer, fit_recognizer, likeliest
from app.models.recognition.views import full_samples
from app.numerics.arrays import FloatArray, IntArray

Labels = Sequence[str | None]

MAX_JUDGED = 1000
"""Of larger libraries, a random subset of this many clips is judged by the methods other than the
default one, whose guesses are stored for every clip."""

MAX_LIBRARY = 2500
"""Largest number of clips from which these other methods learn and are judged: four fifths of them
are as many as the methods use (app.models.recognition.multilinear.MAX_TAKES)."""

_CURVE = ("threshold", "false_acceptance", "false_rejection")


class Clips(NamedTuple):
    """Training clips: samples (clips, 1250), or of another width if the method needs it; labels
    and groups (clips,) each; copies: (clips,) for the default method, None for no copies."""

    samples: FloatArray
    persons: Labels
    tasks: Labels
    groups: Sequence[str]
    copies: ClipCopies | None = None

    def part(self, index: IntArray) -> Clips:
        """The clips at these indices."""
        chosen = index.tolist()
        return Clips(
            self.samples[index],
            [self.persons[i] for i in chosen],
            [self.tasks[i] for i in chosen],
            [self.groups[i] for i in chosen],
            None if self.copies is None else [self.copies[i] for i in chosen],
        )


Guess = tuple[str | None, str | None]
"""The best person and the best task of a clip; None where there is no candidate."""


class HeldOut(NamedTuple):
    """How well clips are recognized by models that have not seen them.

    figures: shares by method; guesses: of the default method, one for each clip, or empty if the
    method cannot be fitted.
    """

    figures: dict[str, dict[str, float]]
    guesses: list[Guess]


_GuessAll = Callable[[Clips, FloatArray], list[Guess]]


def held_out_recognition(
    samples: FloatArray,
    persons: Labels,
    tasks: Labels,
    groups: Sequence[str],
    folds: int = FOLDS,
    seed: int = 0,
    *,
    wide: FloatArray | None = None,
    copies: ClipCopies | None = None,
) -> HeldOut:
    """Shares of recognized clips; each clip is judged by a model of the other folds.

    samples: (clips, 1250); wide: (clips, 512) wide motion vectors, for the default method;
    groups: (clips,) clips of one recording share a value and a fold; copies: (clips,) disturbed
    copies of some clips, for the default method. The methods get no label of a judged clip.

    The figures are by method: "default", "multilinear", "perera", "pca" (flat PCA) and "prior"
    (the most frequent label of the training folds). They are the shares "person", "task" and
    "both" of the clips that have the label, and "clips", the number of clips with both labels.
    The best candidate counts, even if the method calls it new. A method that cannot be fitted is
    left out.
    """
    full = samples if wide is None else full_samples(samples, wide)
    fold = grouped_folds(groups, folds, seed=seed)
    figures: dict[str, dict[str, float]] = {}
    guesses: list[Guess] = []
    with suppress(NotEnoughLabels):
        clips = Clips(np.asarray(full), persons, tasks, groups, copies)
        guesses = _guesses(_default, clips, fold, np.arange(len(fold)))
        figures["default"] = _shares(guesses, persons, tasks)
    methods = {
        "multilinear": _multilinear,
        "perera": _perera,
        "pca": _flat_pca,
        "prior": _prior,
    }
    others = _figures(methods, samples, persons, tasks, groups, folds, seed)
    return HeldOut(figures | others, guesses)


def signature_figures(
    angles: FloatArray,
    persons: Labels,
    tasks: Labels,
    groups: Sequence[str],
    folds: int = FOLDS,
    seed: int = 0,
) -> dict[str, dict[str, float]]:
    """The same figures of "signatures", "pca" and "prior" on angle samples (clips, 642)."""
    methods = {"signatures": _signatures, "pca": _flat_pca, "prior": _prior}
    return _figures(methods, angles, persons, tasks, groups, folds, seed)


def _figures(
    methods: Mapping[str, _GuessAll],
    samples: FloatArray,
    persons: Labels,
    tasks: Labels,
    groups: Sequence[str],
    folds: int,
    seed: int,
) -> dict[str, dict[str, float]]:
    order = np.random.RandomState(seed).permutation(len(groups))
    some = np.sort(order[:MAX_LIBRARY])
    clips = Clips(np.asarray(samples), persons, tasks, groups).part(some)
    fold = grouped_folds(groups, folds, seed=seed)[some]
    judged = np.searchsorted(some, np.sort(order[:MAX_JUDGED]))
    who, what = ([labels[i] for i in judged] for labels in (clips.persons, clips.tasks))
    figures = {}
    for name, method in methods.items():
        try:
            guesses = _guesses(method, clips, fold, judged)
        except NotEnoughLabels:
            continue
        figures[name] = _shares([guesses[i] for i in judged], who, what)
    return figures


def unknown_figures(record: Recognizer | TensorRecognizer) -> dict[str, dict[str, Any]]:
    """False acceptance, false rejection, balanced accuracy and area under the curve for "person"
    and "task", and "curve", from which a false-accept rate can be chosen.

    The figures are those of the clips, persons and tasks that were held out when `record` was
    fitted. The threshold was chosen on them too, so the figures are slightly too good. If the
    library has few repeated takes, the clips of known labels are simulated takes. If there were too
    few labels to hold one out, "reason" says so instead.
    """
    figures: dict[str, dict[str, Any]] = {}
    labels = record.model if isinstance(record, TensorRecognizer) else record
    for name, names in (("person", labels.persons), ("task", labels.tasks)):
        calibration = getattr(record, f"{name}_calibration")
        if 0 < len(names) < MIN_LABELS:
            figures[name] = {"reason": _too_few(name, len(names))}
        if len(calibration.new_novelty) and len(calibration.known_novelty):
            accepted, rejected = calibration.error_rates()
            figures[name] = {
                "false_acceptance": accepted,
                "false_rejection": rejected,
                "balanced_accuracy": 1 - (accepted + rejected) / 2,
                "area_under_curve": calibration.area_under_curve(),
                "curve": [dict(zip(_CURVE, point, strict=True)) for point in calibration.curve()],
            }
    return figures


def _too_few(name: str, count: int) -> str:
    found = f"1 {name}" if count == 1 else f"{count} {name}s"
    return f"No {name} could be held out: the clips have {found}, and {MIN_LABELS} are needed."


def _guesses(guess: _GuessAll, clips: Clips, fold: IntArray, judged: IntArray) -> list[Guess]:
    """For each of the `judged` clips the best person and task, by a model of all other folds."""
    guesses: list[Guess] = [(None, None)] * len(fold)
    for each in np.unique(fold[judged]):
        train, probe = np.flatnonzero(fold != each), judged[fold[judged] == each]
        found = guess(clips.part(train), clips.samples[probe])
        for index, best in zip(probe, found, strict=True):
            guesses[index] = best
    return guesses


def _of_recognitions(recognitions: Iterable[Recognition]) -> list[Guess]:
    return [(_best(found.person), _best(found.task)) for found in recognitions]


def _best(answer: Answer) -> str | None:
    return answer.candidates[0].label if answer.candidates else None


def _shares(guesses: list[Guess], persons: Labels, tasks: Labels) -> dict[str, float]:
    who = [guess[0] == person for guess, person in zip(guesses, persons, strict=True) if person]
    what = [guess[1] == task for guess, task in zip(guesses, tasks, strict=True) if task]
    pairs = zip(guesses, persons, tasks, strict=True)
    both = [guess == (person, task) for guess, person, task in pairs if person and task]
    shares = {"person": who, "task": what, "both": both}
    return {name: float(np.mean(hits)) for name, hits in shares.items() if hits} | {
        "clips": float(len(both))
    }


def _default(clips: Clips, probes: FloatArray) -> list[Guess]:
    # Only the best candidate counts, so the costly calibration is left out.
    return likeliest(fit_recognizer(*clips, is_calibrated=False), probes)


def _multilinear(clips: Clips, probes: FloatArray) -> list[Guess]:
    record = fit_multilinear(clips.samples, clips.persons, clips.tasks)
    return _of_recognitions(recognize_multilinear(record, probe) for probe in probes)


def _signatures(clips: Clips, probes: FloatArray) -> list[Guess]:
    record = fit_multilinear(clips.samples, clips.persons, clips.tasks, moments=SAMPLES)
    return _of_recognitions(recognize_multilinear(record, probe) for probe in probes)


def _perera(clips: Clips, probes: FloatArray) -> list[Guess]:
    # Only the best candidate counts, so the costly calibration of unknown labels is left out.
    record = uncalibrated(clips.samples, clips.persons, clips.tasks)
    return _of_recognitions(recognize_by_tensor(record, probes))


def _flat_pca(clips: Clips, probes: FloatArray) -> list[Guess]:
    record = fit_flat_pca(clips.samples, clips.persons, clips.tasks)
    return _of_recognitions(recognize_flat(record, probe) for probe in probes)


def _prior(clips: Clips, probes: FloatArray) -> list[Guess]:
    both = Recognition(_most_frequent(clips.persons), _most_frequent(clips.tasks))
    return _of_recognitions([both] * len(probes))


def _most_frequent(labels: Labels) -> Answer:
    names = sorted(label for label in labels if label)
    if not names:
        return NO_ANSWER
    ((name, _),) = Counter(names).most_common(1)
    return given(name, (name,))
