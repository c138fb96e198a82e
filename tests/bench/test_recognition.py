"""Person and task recognition on the real clips, held out, beside the prior.

Run: pytest -m bench -s tests/bench/test_recognition.py
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from app.analysis.descriptors.motion_sample import SAMPLES
from app.models.held_out.danced_tasks import arrange
from app.models.held_out.perera_experiment import perera_tables
from app.models.held_out.recognition import held_out_recognition, unknown_figures
from app.models.recognition.answers import Answer, Recognition
from app.models.recognition.flat_pca import fit_flat_pca, recognize_flat
from app.models.recognition.multilinear import fit_multilinear, recognize_multilinear
from app.models.recognition.perera import fit_tensor_recognizer, recognize_by_tensor
from app.models.recognition.recognizer import fit_recognizer, recognize, recognize_many
from app.models.recognition.task_model import Reading
from app.numerics.area_under_curve import area_under_curve
from tests.bench.page import Section
from tests.bench.recognition_library import Library, read_library

FIGURES = Section(
    "recognition",
    "Who is it, and what are they doing?",
    trials="each clip is recognized once in each round in which it was not learned",
    chance="the most frequent label, printed as the prior",
)

pytestmark = pytest.mark.bench


@pytest.fixture(scope="module")
def library() -> Library:
    return read_library()


METHODS = ("default", "multilinear", "signatures", "perera", "pca")


def _recognize(
    library: Library, method: str, train: np.ndarray, probe: np.ndarray
) -> list[Recognition]:
    """Recognize the clips of `probe` by a model of `train`, without a known person or task."""
    learned = library.part(train, method)
    asked, _, _ = library.part(probe, method)
    if method == "default":
        return recognize_many(fit_recognizer(*learned, copies=library.copies(train)), asked)
    if method == "perera":
        return recognize_by_tensor(fit_tensor_recognizer(*learned), asked)
    if method == "pca":
        flat = fit_flat_pca(*learned)
        return [recognize_flat(flat, sample) for sample in asked]
    model = fit_multilinear(*learned, moments=SAMPLES if method == "signatures" else None)
    return [recognize_multilinear(model, sample) for sample in asked]


def test_the_whole_library(library: Library) -> None:
    labels = library.persons, library.tasks, library.groups
    copies = library.copies(np.ones(len(library.tasks), dtype=bool))
    figures = held_out_recognition(
        library.samples, *labels, wide=library.wide, copies=copies
    ).figures
    _print("all clips, 5 folds", figures)
    record = fit_recognizer(library.full, *labels, copies)
    _print("unknown, all clips (threshold chosen on these)", unknown_figures(record))
    assert figures["default"]["task"] > 0.85
    assert figures["default"]["person"] > 0.8
    assert figures["default"]["both"] > figures["prior"]["both"] + 0.6


def test_five_takes_a_cell(library: Library) -> None:
    second = library.takes > 0
    samples, who, what = library.part(second, "multilinear")
    takes = [str(take) for take in library.takes[second]]
    wide, copies = library.wide[second], library.copies(second)
    figures = held_out_recognition(samples, who, what, takes, wide=wide, copies=copies).figures
    _print("dataset 2, a take held out in turn", figures)
    assert figures["default"]["task"] >= 0.993
    assert figures["default"]["person"] >= 0.996
    assert figures["multilinear"]["both"] >= 0.97


@pytest.mark.parametrize("method", METHODS)
def test_takes_that_chose_nothing(library: Library, method: str) -> None:
    """Without known labels: learn one take of each cell, each in turn, or takes 1 to 3."""
    rounds = [((take,), tuple({1, 2, 3, 4, 5} - {take})) for take in range(1, 6)]
    one = np.mean([_shares(library, method, *chosen) for chosen in rounds], axis=0)
    three = _shares(library, method, (1, 2, 3), (4, 5))
    _print(
        f"dataset 2, {method}",
        {
            "1 take": {"task": one[0], "person": one[1]},
            "3 takes": {"task": three[0], "person": three[1]},
        },
    )
    if method == "default":
        assert one[0] >= 0.965
        assert one[1] >= 0.93
        assert three[0] >= 0.985
        assert three[1] >= 0.975


def _shares(
    library: Library, method: str, train: tuple[int, ...], probe: tuple[int, ...]
) -> tuple[float, float]:
    """Shares of tasks and of persons that are recognized."""
    asked = np.isin(library.takes, probe)
    found = _recognize(library, method, np.isin(library.takes, train), asked)
    _, who, what = library.part(asked)
    return _right([f.task for f in found], what), _right([f.person for f in found], who)


def test_the_other_factor_known(library: Library) -> None:
    second = library.takes > 0
    hits = []
    for take in range(1, 6):
        train, probe = second & (library.takes != take), library.takes == take
        default = fit_recognizer(*library.part(train), copies=library.copies(train))
        multilinear = fit_multilinear(*library.part(train, "multilinear"))
        plain = library.part(probe, "multilinear")[0]
        for full, sample, who, what in zip(
            library.part(probe)[0], plain, *library.part(probe)[1:], strict=True
        ):
            hits.append(
                [
                    recognize(default, full, known_task=what).person.candidates[0].label == who,
                    recognize(default, full, known_person=who).task.candidates[0].label == what,
                    recognize_multilinear(multilinear, sample, known_task=what)
                    .person.candidates[0]
                    .label
                    == who,
                    recognize_multilinear(multilinear, sample, known_person=who)
                    .task.candidates[0]
                    .label
                    == what,
                ]
            )
    shares = np.mean(hits, axis=0)
    _print(
        "dataset 2, the other factor known",
        {
            "default": {"person": shares[0], "task": shares[1]},
            "multilinear": {"person": shares[2], "task": shares[3]},
        },
    )
    assert shares.min() > 0.95


@pytest.mark.parametrize("method", ["default", "perera"])
@pytest.mark.parametrize("factor", ["task", "person"])
@pytest.mark.parametrize("learned", [3, 4])
def test_the_unknown(library: Library, factor: str, method: str, learned: int) -> None:
    """Leave each task (person) out in turn; learn the first takes and probe the others."""
    labels = np.array(library.tasks if factor == "task" else [p or "" for p in library.persons])
    asked = library.takes > learned
    novelties: dict[str, list[float]] = {"new": [], "known": []}
    rejected: dict[str, float] = {}
    others: list[list[bool]] = []
    for name in np.unique(labels[library.takes > 0]):
        train = (library.takes > 0) & ~asked & (labels != name)
        recognized = _recognize(library, method, train, asked)
        found = [getattr(f, factor) for f in recognized]
        strange = labels[asked] == name
        others += [
            [f.task.known, f.task.candidates[0].label == task]
            for f, task, is_new in zip(recognized, library.part(asked)[2], strange, strict=True)
            if is_new
        ]
        beyond = np.array([0.5 - sum(c.score for c in answer.candidates) for answer in found])
        novelties["new"] += beyond[strange].tolist()
        novelties["known"] += beyond[~strange].tolist()
        rejected[str(name)] = float((beyond[strange] > 0).mean())
    new, known = (np.array(novelties[each]) for each in ("new", "known"))
    shares = {
        "new_rejected": float((new > 0).mean()),
        "known_accepted": float((known <= 0).mean()),
        "area_under_curve": area_under_curve(new, known),
        "worst": min(rejected.values()),
    }
    shares["balanced_accuracy"] = (shares["new_rejected"] + shares["known_accepted"]) / 2
    _print(f"dataset 2, a new {factor}, takes 1-{learned}", {method: shares})
    if factor == "person":
        known_task, right_task = np.mean(others, axis=0)
        _print(
            "tasks of new persons",
            {method: {"called_known": known_task, "best_right": right_task}},
        )
    if method == "default":
        assert shares["balanced_accuracy"] > 0.92
        assert shares["area_under_curve"] > 0.98
        assert shares["worst"] >= 0.7  # of 7 clips; two waves of a new task pass as known


def test_perera_s_experiment(library: Library) -> None:
    """Tables 3 to 5 on the cycles of dataset 2, in both readings of the paper."""
    second = np.flatnonzero(library.takes > 0)
    danced = arrange(
        [library.cycles[i] for i in second],
        [library.persons[i] for i in second],
        [library.tasks[i] for i in second],
    )
    for reading in Reading:
        rows = perera_tables(danced, reading)
        shares = {
            f"{row.table} {row.category}": {"found": row.accuracy, "paper": row.paper}
            | ({"balanced": row.balanced_accuracy} if row.table == 4 else {})
            for row in rows
        }
        _print(f"Perera's tables, {reading.value}", shares)
        assert rows[0].accuracy > 0.8


def test_fitting_and_probing_are_quick(library: Library) -> None:
    labels = library.persons, library.tasks, library.groups
    copies = library.copies(np.ones(len(library.tasks), dtype=bool))
    start = time.process_time()
    record = fit_recognizer(library.full, *labels, copies)
    fitted = time.process_time() - start
    start = time.process_time()
    for sample in library.full[:100]:
        recognize(record, sample)
    probe = (time.process_time() - start) / 100
    _print("CPU seconds", {"default": {"fit": fitted, "probe": probe}})
    assert fitted < 5.0
    assert probe < 0.015


def _right(answers: list[Answer], truth: list[str] | list[str | None]) -> float:
    best = [answer.candidates[0].label for answer in answers]
    return float(np.mean([label == true for label, true in zip(best, truth, strict=True)]))


def _print(what: str, figures: Mapping[str, Mapping[str, Any]]) -> None:
    FIGURES.print(f"\n{what}")
    for name, shares in figures.items():
        numbers = {key: value for key, value in shares.items() if not isinstance(value, list)}
        line = "  ".join(f"{key} {value:.4g}" for key, value in numbers.items())
        FIGURES.print(f"  {name:12} {line}")
