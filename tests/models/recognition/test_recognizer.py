from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.recognition.answers import Recognition
from app.models.recognition.recognizer import (
    Recognizer,
    fit_recognizer,
    likeliest,
    recognize,
    recognize_many,
)
from tests.models.factor_clips import WIDTH, FactorClips, factor_clips


@pytest.fixture(scope="module")
def clips() -> FactorClips:
    return factor_clips()


@pytest.fixture(scope="module")
def record(clips: FactorClips) -> Recognizer:
    return fit_recognizer(*clips.where(clips.takes > 0))


def share_of_tasks(found: list[Recognition], truth: list[str]) -> float:
    best = [one.task.candidates[0].label for one in found]
    return float(np.mean([label == task for label, task in zip(best, truth, strict=True)]))


def test_held_out_takes_are_recognized_with_calibrated_scores(
    clips: FactorClips, record: Recognizer
) -> None:
    samples, who, what = clips.where(clips.takes == 0)
    found = recognize_many(record, samples)
    assert np.mean([f.person.label == p for f, p in zip(found, who, strict=True)]) > 0.9
    assert np.mean([f.task.label == t for f, t in zip(found, what, strict=True)]) > 0.9
    for one in found:
        for answer in (one.person, one.task):
            scores = [candidate.score for candidate in answer.candidates]
            assert scores == sorted(scores, reverse=True)
            assert all(0 <= score <= 1 for score in scores)
            assert sum(scores) <= 1 + 1e-9


def test_a_cell_never_recorded_is_recognized_by_its_person_and_task(clips: FactorClips) -> None:
    missing = np.array([p == "p1" and t == "t2" for p, t in clips.labels])
    record = fit_recognizer(*clips.where(~missing))
    found = recognize_many(record, clips.samples[missing])
    assert {(f.person.candidates[0].label, f.task.candidates[0].label) for f in found} == {
        ("p1", "t2")
    }


@pytest.mark.parametrize("factor", ["person", "task"])
def test_a_new_label_is_unknown(clips: FactorClips, factor: str) -> None:
    labels = clips.persons if factor == "person" else clips.tasks
    new = np.array([label.endswith("3") for label in labels])
    record = fit_recognizer(*clips.where(~new & (clips.takes > 0)))
    strange = [getattr(f, factor) for f in recognize_many(record, clips.samples[new])]
    usual = [
        getattr(f, factor)
        for f in recognize_many(record, clips.where(~new & (clips.takes == 0))[0])
    ]
    assert np.mean([not a.known for a in strange]) > 0.8
    assert np.mean([a.known for a in usual]) > 0.8
    assert all((a.label is None) == (not a.known) for a in strange + usual)


def test_one_take_for_each_cell_is_enough(clips: FactorClips) -> None:
    record = fit_recognizer(*clips.where(clips.takes == 1))
    samples, who, what = clips.where(clips.takes == 0)
    found = recognize_many(record, samples)
    right = [
        f.person.candidates[0].label == p and f.task.candidates[0].label == t
        for f, p, t in zip(found, who, what, strict=True)
    ]
    assert np.mean(right) > 0.9


@pytest.mark.parametrize("factor", ["person", "task"])
def test_new_labels_are_recognized_with_one_take_for_each_cell(factor: str) -> None:
    clips = factor_clips(persons=6, tasks=7)
    labels = clips.persons if factor == "person" else clips.tasks
    new = np.array([label.endswith("3") for label in labels])
    record = fit_recognizer(*clips.where(~new & (clips.takes == 1)))
    assert record.persons_by_both
    known = [
        np.mean([getattr(f, factor).known for f in recognize_many(record, clips.where(asked)[0])])
        for asked in (~new & (clips.takes != 1), new)
    ]
    assert known[0] > 0.9
    assert known[1] < 0.2


def test_libraries_without_some_labels_give_the_other_answers(clips: FactorClips) -> None:
    samples, who, what = clips.where(clips.takes > 0)
    probe, _, truth = clips.where(clips.takes == 0)
    none: list[str | None] = [None] * len(who)
    found = recognize_many(fit_recognizer(samples, none, what), probe)
    assert all(f.person.label is None and not f.person.candidates for f in found)
    assert (
        np.mean([f.task.candidates[0].label == t for f, t in zip(found, truth, strict=True)]) > 0.9
    )
    halves = [p if i % 2 else None for i, p in enumerate(who)]
    mixed = recognize_many(fit_recognizer(samples, halves, what), probe)
    assert (
        np.mean([f.task.candidates[0].label == t for f, t in zip(mixed, truth, strict=True)]) > 0.9
    )
    persons_only = recognize(fit_recognizer(samples, who, none), probe[0])
    assert persons_only.task.candidates == ()
    assert persons_only.person.candidates


def test_a_known_label_is_in_the_answer_and_helps(clips: FactorClips, record: Recognizer) -> None:
    told = recognize(record, clips.samples[-1], known_person="p4")
    assert (told.person.label, told.person.score) == ("p4", 1.0)
    assert told.task.label == "t5"
    misled = recognize(record, clips.samples[-1], known_person="p0")
    assert misled.task.score <= told.task.score
    stranger = recognize(record, clips.samples[0], known_person="nobody")
    assert stranger.person.label is None
    assert stranger.task.candidates[0].label == "t0"
    assert recognize(record, clips.samples[0], known_task="t0").person.candidates[0].label == "p0"


def test_a_record_comes_back_from_its_arrays(clips: FactorClips, record: Recognizer) -> None:
    arrays, meta = record.to_arrays()
    again = Recognizer.from_arrays(arrays, json.loads(json.dumps(meta)))
    for known in (None, "p1"):
        ours, theirs = (recognize(r, clips.samples[3], known) for r in (record, again))
        assert ours == theirs
    with pytest.raises(ValueError, match="version"):
        Recognizer.from_arrays(arrays, meta | {"version": 0})


def test_fitting_twice_gives_the_same(clips: FactorClips, record: Recognizer) -> None:
    arrays, meta = fit_recognizer(*clips.where(clips.takes > 0)).to_arrays()
    ours, our_meta = record.to_arrays()
    assert meta == our_meta
    for name, array in arrays.items():
        np.testing.assert_array_equal(array, ours[name])


def test_information_of_the_wide_vector_alone_is_used(clips: FactorClips) -> None:
    """Motion samples are the same of all persons: only what follows them tells them apart."""
    rng = np.random.default_rng(5)
    blind = clips.samples.copy()
    blind[:, :20] = rng.normal(scale=0.05, size=(len(blind), 20))
    _, who, what = clips.where(clips.takes > 0)
    _, truth, _ = clips.where(clips.takes == 0)
    told = [
        recognize_many(
            fit_recognizer(rows[clips.takes > 0][:, :end], who, what, sample_length=20),
            rows[clips.takes == 0][:, :end],
        )
        for rows, end in ((blind, WIDTH), (blind, 20))
    ]
    right = [
        np.mean([f.person.candidates[0].label == p for f, p in zip(found, truth, strict=True)])
        for found in told
    ]
    assert right[0] > 0.9
    assert right[1] < 0.5


def test_a_recognizer_with_copies_knows_disturbed_clips_and_new_persons() -> None:
    """The disturbance moves clips farther than takes differ; copies have other draws of it."""
    clips = factor_clips(persons=7)
    rng = np.random.default_rng(6)

    def disturbed(samples: np.ndarray) -> np.ndarray:
        return samples + 0.2 * rng.normal(size=samples.shape)

    new = np.array([person == "p3" for person in clips.persons])
    samples, who, what = clips.where(~new & (clips.takes > 0))
    copies = [disturbed(np.repeat(row[None], 6, axis=0)) for row in samples]
    asked, truth, _ = clips.where(~new & (clips.takes == 0))
    unknown = {}
    for name, own in (("without", None), ("with", copies)):
        record = fit_recognizer(samples, who, what, copies=own)
        found = [one.person for one in recognize_many(record, disturbed(asked))]
        unknown[name] = np.mean([not one.known for one in found])
        assert [one.candidates[0].label for one in found] == truth
        strangers = recognize_many(record, clips.samples[new])
        assert np.mean([not one.person.known for one in strangers]) > 0.8
        assert np.mean([one.person.known for one in recognize_many(record, asked)]) > 0.8
    assert unknown["without"] > 0.8
    assert unknown["with"] < 0.2


def test_copies_of_some_clips_are_enough(clips: FactorClips) -> None:
    samples, who, what = clips.where(clips.takes > 0)
    rng = np.random.default_rng(7)
    copies = [
        row + 0.01 * rng.normal(size=(6, WIDTH)) if i % 4 == 0 else None
        for i, row in enumerate(samples)
    ]
    asked, _, truth = clips.where(clips.takes == 0)
    found = recognize_many(fit_recognizer(samples, who, what, copies=copies), asked)
    assert share_of_tasks(found, truth) > 0.9
    none = recognize_many(fit_recognizer(samples, who, what, copies=[None] * len(samples)), asked)
    assert none == recognize_many(fit_recognizer(samples, who, what), asked)


def test_a_clip_that_was_learned_is_known_even_if_its_cell_has_no_other_take(
    clips: FactorClips,
) -> None:
    alone = np.array([person == "p4" for person in clips.persons])
    samples, who, what = clips.where(~alone | (clips.takes == 1))
    found = recognize_many(
        fit_recognizer(samples, who, what), clips.samples[alone & (clips.takes == 1)]
    )
    assert all(one.person.label == "p4" for one in found)


@pytest.mark.parametrize("labels", [[], [None, None, None], ["a", None, None]])
def test_too_few_labels_are_refused(labels: list[str | None]) -> None:
    with pytest.raises(NotEnoughLabels):
        fit_recognizer(np.zeros((len(labels), WIDTH)), labels, [None] * len(labels))


@pytest.mark.parametrize("labels", [["a", "a"], ["a", "b"], ["a", "b", "c", "c"]])
def test_small_libraries_and_motionless_clips_give_finite_answers(labels: list[str]) -> None:
    record = fit_recognizer(np.ones((len(labels), WIDTH)), labels, labels)
    for probe in (np.ones(WIDTH), np.full(WIDTH, 1e6)):
        found = recognize(record, probe)
        assert np.isfinite(found.person.score)
        assert np.isfinite(found.task.score)


def test_the_likeliest_labels_are_the_first_candidates_and_need_no_calibration(
    clips: FactorClips, record: Recognizer
) -> None:
    quick = fit_recognizer(*clips.where(clips.takes > 0), is_calibrated=False)
    asked = clips.samples + np.random.default_rng(0).normal(scale=0.3, size=clips.samples.shape)
    best = [
        (found.person.candidates[0].label, found.task.candidates[0].label)
        for found in recognize_many(record, asked)
    ]
    assert likeliest(quick, asked) == likeliest(record, asked) == best
