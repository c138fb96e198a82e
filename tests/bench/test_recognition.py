"""Person and task recognition on the real clips, held out, beside the prior.

Run: pytest -m bench -s tests/bench/test_recognition.py
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
import pytest

from app.analysis.motion_sample import motion_sample
from app.formats.read import read_recording
from app.models.folds import recording_of
from app.models.multilinear import fit_multilinear, recognise_multilinear
from app.models.recogniser import fit_recogniser, recognise, recognise_many
from app.models.recognition import Answer
from app.models.recognition_figures import held_out_recognition_figures, unknown_figures
from app.motion.body_frame import body_track
from app.motion.canonical import canonicalise
from tests.real_clips import manifest, real_clips

pytestmark = pytest.mark.bench


@dataclass(frozen=True)
class Library:
    samples: np.ndarray
    persons: list[str | None]
    tasks: list[str]
    groups: list[str]
    takes: np.ndarray
    """Take of a dataset-2 clip, 1..5; 0 for the others."""

    def part(self, chosen: np.ndarray) -> tuple[np.ndarray, list[str | None], list[str]]:
        index = np.flatnonzero(chosen)
        who, what = [self.persons[i] for i in index], [self.tasks[i] for i in index]
        return self.samples[index], who, what


@pytest.fixture(scope="module")
def library() -> Library:
    rows = [row for row in manifest() if row["path"].endswith(".bvh")]
    second = [row["path"].startswith("bandai-namco-2") for row in rows]
    takes = [int(r["path"][-7:-4]) if s else 0 for r, s in zip(rows, second, strict=True)]
    return Library(
        np.stack([_sample(row["path"], float(row["fps"])) for row in rows]),
        [row["person"] or None for row in rows],
        [row["task"] for row in rows],
        [recording_of(row["path"]) for row in rows],
        np.array(takes),
    )


def _sample(path: str, fps: float) -> np.ndarray:
    recording = read_recording((real_clips() / path).read_bytes())
    return motion_sample(body_track(canonicalise(recording, frame_rate=fps)))


def test_the_whole_library(library: Library) -> None:
    figures = held_out_recognition_figures(
        library.samples, library.persons, library.tasks, library.groups
    )
    _tell("all clips, 5 folds", figures)
    record = fit_recogniser(library.samples, library.persons, library.tasks, library.groups)
    _tell("unknown, all clips (threshold chosen on these)", unknown_figures(record))
    assert figures["default"]["task"] > 0.85
    assert figures["default"]["person"] > 0.8
    assert figures["default"]["both"] > figures["prior"]["both"] + 0.6


def test_five_takes_a_cell(library: Library) -> None:
    samples, who, what = library.part(library.takes > 0)
    takes = [str(take) for take in library.takes[library.takes > 0]]
    figures = held_out_recognition_figures(samples, who, what, takes)
    _tell("dataset 2, a take held out in turn", figures)
    assert figures["default"]["task"] >= 0.993
    assert figures["default"]["person"] >= 0.996
    assert figures["multilinear"]["both"] >= 0.97


def test_one_take_a_cell(library: Library) -> None:
    shares = []
    for take in range(1, 6):
        record = fit_recogniser(*library.part(library.takes == take))
        samples, who, what = library.part((library.takes > 0) & (library.takes != take))
        found = recognise_many(record, samples)
        shares.append(
            [_right([f.task for f in found], what), _right([f.person for f in found], who)]
        )
    task, person = np.mean(shares, axis=0)
    _tell("dataset 2, one take a cell", {"default": {"task": task, "person": person}})
    assert task >= 0.976
    assert person >= 0.930


def test_the_other_factor_known(library: Library) -> None:
    second = library.takes > 0
    hits = []
    for take in range(1, 6):
        train = library.part(second & (library.takes != take))
        default, multilinear = fit_recogniser(*train), fit_multilinear(*train)
        for sample, who, what in zip(*library.part(library.takes == take), strict=True):
            hits.append(
                [
                    recognise(default, sample, known_task=what).person.candidates[0].label == who,
                    recognise(default, sample, known_person=who).task.candidates[0].label == what,
                    recognise_multilinear(multilinear, sample, known_task=what)
                    .person.candidates[0]
                    .label
                    == who,
                    recognise_multilinear(multilinear, sample, known_person=who)
                    .task.candidates[0]
                    .label
                    == what,
                ]
            )
    shares = np.mean(hits, axis=0)
    _tell(
        "dataset 2, the other factor known",
        {
            "default": {"person": shares[0], "task": shares[1]},
            "multilinear": {"person": shares[2], "task": shares[3]},
        },
    )
    assert shares.min() > 0.95


@pytest.mark.parametrize("factor", ["task", "person"])
def test_the_unknown(library: Library, factor: str) -> None:
    """Each task (person) left out in turn, takes 1-4 learned, take 5 probed."""
    labels = np.array(library.tasks if factor == "task" else [p or "" for p in library.persons])
    new, known = [], []
    for name in np.unique(labels[library.takes > 0]):
        record = fit_recogniser(*library.part((library.takes % 5 > 0) & (labels != name)))
        samples, _, _ = library.part(library.takes == 5)
        found = [getattr(f, factor).known for f in recognise_many(record, samples)]
        strange = labels[library.takes == 5] == name
        new += [f for f, s in zip(found, strange, strict=True) if s]
        known += [f for f, s in zip(found, strange, strict=True) if not s]
    accepted, rejected = float(np.mean(new)), 1 - float(np.mean(known))
    shares = {"false_acceptance": accepted, "false_rejection": rejected}
    shares["balanced_accuracy"] = 1 - (accepted + rejected) / 2
    _tell(f"dataset 2, a new {factor}", {"default": shares})
    assert shares["balanced_accuracy"] > 0.8


def test_fitting_and_probing_are_quick(library: Library) -> None:
    start = time.perf_counter()
    record = fit_recogniser(library.samples, library.persons, library.tasks, library.groups)
    fitted = time.perf_counter() - start
    start = time.perf_counter()
    for sample in library.samples[:100]:
        recognise(record, sample)
    probe = (time.perf_counter() - start) / 100
    _tell("seconds", {"default": {"fit": fitted, "probe": probe}})
    assert fitted < 2.0
    assert probe < 0.005


def _right(answers: list[Answer], truth: list[str] | list[str | None]) -> float:
    best = [answer.candidates[0].label for answer in answers]
    return float(np.mean([label == true for label, true in zip(best, truth, strict=True)]))


def _tell(what: str, figures: dict[str, dict[str, float]]) -> None:
    print(f"\n{what}")
    for name, shares in figures.items():
        told = "  ".join(f"{key} {value:.4g}" for key, value in shares.items())
        print(f"  {name:12} {told}")
