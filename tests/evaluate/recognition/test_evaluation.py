"""Recognition, judged with labels: all ways of holding out, and parts that cannot be judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app import evaluate
from app.errors import BadField, NotEnoughLabels
from app.evaluate.recognition.evaluation import judge_clips, takes_key
from app.evaluate.recognition.methods import METHODS
from app.evaluate.recognition.results import RecognitionEvaluation
from app.evaluate.recognition.rounds import LeftOut
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter
from tests.evaluate.recognition.recognition_library import invented, some

QUICK = {name: METHODS[name] for name in ("default", "mean-motion", "prior")}


@pytest.fixture(scope="module")
def judged() -> RecognitionEvaluation:
    return judge_clips(invented(persons=3, tasks=4, takes=4, sources=3), QUICK)


def test_every_part_is_judged(judged: RecognitionEvaluation) -> None:
    assert set(judged.held_out) == set(LeftOut)
    assert set(judged.takes) == {3, 1}
    assert [one.method for one in judged.label_given] == list(QUICK)
    assert judged.not_judged == {}
    assert all(seconds.fit >= 0 and seconds.probe > 0 for seconds in judged.seconds.values())


def test_the_default_is_better_than_its_baselines(judged: RecognitionEvaluation) -> None:
    for held in (*judged.held_out.values(), *judged.takes.values()):
        default, mean_motion, prior = (one.recognized.task.value for one in held.methods)
        assert default is not None
        assert default >= mean_motion
        assert default > prior + 0.3
    by_take = judged.held_out[LeftOut.TAKE].methods[0]
    assert by_take.recognized.both.value == 1.0
    assert by_take.recognized.both.of == 48
    assert by_take.confusion["person"][1].tolist() == np.eye(3).tolist()


def test_each_left_out_label_is_a_category(judged: RecognitionEvaluation) -> None:
    for way, factor, count in ((LeftOut.PERSON, "person", 3), (LeftOut.TASK, "task", 4)):
        held = judged.held_out[way]
        assert held.rounds == count
        found = held.methods[0].unknown[factor]
        assert [one.label for one in found.categories] == [f"{factor[0]}{i}" for i in range(count)]
        assert found.refused.of == 48
        assert found.area_under_curve > 0.6
    strangers = judged.held_out[LeftOut.PERSON].methods[0].of_new
    assert (strangers.person.of, strangers.task.of) == (0, 48)
    assert (strangers.task.value or 0.0) > 0.9


def test_no_person_spans_sources(judged: RecognitionEvaluation) -> None:
    for one in judged.held_out[LeftOut.SOURCE].methods:
        assert one.recognized.person.of == 0
        assert set(one.by_name) == {"s0", "s1", "s2"}
        assert all(found.task.of == 16 for found in one.by_name.values())
    assert "task" not in judged.held_out[LeftOut.SOURCE].methods[0].unknown


def test_the_other_label_helps_the_mean_motion(judged: RecognitionEvaluation) -> None:
    mean_motion = judged.label_given[1]
    assert (mean_motion.given.person.value or 0) > (mean_motion.neither.person.value or 0)
    assert mean_motion.given.person.of == 48


def test_the_evaluation_is_deterministic(judged: RecognitionEvaluation) -> None:
    guessing = {name: QUICK[name] for name in ("mean-motion", "prior")}
    again = judge_clips(invented(persons=3, tasks=4, takes=4, sources=3), guessing)
    for way, held in judged.held_out.items():
        for one, other in zip(held.methods[1:], again.held_out[way].methods, strict=True):
            assert one.recognized == other.recognized
            assert repr(one.unknown) == repr(other.unknown)


def test_steps_are_counted() -> None:
    steps: list[tuple[int, int]] = []
    judge_clips(
        invented(persons=3, tasks=3, takes=2),
        {"prior": METHODS["prior"]},
        lambda done, total: steps.append((done, total)),
    )
    assert [done for done, _ in steps] == list(range(1, len(steps) + 1))
    assert {total for _, total in steps} == {len(steps)}


def test_parts_that_cannot_be_judged_have_a_reason() -> None:
    found = judge_clips(invented(persons=2, tasks=2, takes=2), METHODS)
    assert set(found.held_out) == {LeftOut.TAKE}
    assert set(found.takes) == {1}
    assert set(found.not_judged) == {"person", "task", "source", takes_key(3)}
    assert "there are 2" in found.not_judged["person"]


def test_a_method_that_cannot_learn_has_its_own_reason() -> None:
    clips = invented(persons=3, tasks=4, takes=3)
    found = judge_clips(replace(clips, persons=[None] * len(clips)), METHODS)
    assert "multilinear" not in [one.method for one in found.held_out[LeftOut.TAKE].methods]
    assert "two persons" in found.not_judged["take, multilinear"]
    default = found.held_out[LeftOut.TAKE].methods[0]
    assert default.recognized.person.value is None
    assert default.recognized.task.value == 1.0


def test_a_lone_recording_of_a_task_is_not_counted() -> None:
    clips = some(invented(), np.arange(60))
    clips = replace(clips, tasks=["hop", *list(clips.tasks)[1:]])
    found = judge_clips(clips, {"mean-motion": METHODS["mean-motion"]})
    one = found.held_out[LeftOut.TAKE].methods[0]
    assert one.recognized.task.of == 59
    names, shares = one.confusion["task"]
    assert "hop" not in names or not shares[names.index("hop")].any()


def test_a_library_is_read(ready_library: Library) -> None:
    found = evaluate.judge_recognition(ready_library)
    assert len(found.clips) == 12
    assert set(found.clips.sources) == {"demo"}
    # one take a cell: no person does anything twice
    assert takes_key(1) in found.not_judged
    assert ("perera" in found.not_judged) == (found.perera is None)
    assert {one.method for one in found.held_out[LeftOut.PERSON].methods} == set(METHODS)
    assert found.made is not None
    assert set(found.made) == {"new_task", "new_person"}
    assert all(0 <= row["hit"] <= 1 for rows in found.made.values() for row in rows)


def test_without_recognition_of_persons_no_person_is_read(ready_library: Library) -> None:
    settings = ready_library.settings
    anonymous = settings.model_copy(update={"recognize_persons": False})
    object.__setattr__(ready_library, "settings", anonymous)
    try:
        found = evaluate.judge_recognition(ready_library, methods=("default",))
    finally:
        object.__setattr__(ready_library, "settings", settings)
    assert set(found.clips.persons) == {None}
    assert "there are 0" in found.not_judged["person"]
    assert "recognize_persons" in found.not_judged["perera"]


def test_wrong_arguments_are_refused(ready_library: Library) -> None:
    with pytest.raises(BadField, match="must be one of default"):
        evaluate.judge_recognition(ready_library, methods=("guess",))
    with pytest.raises(BadField, match="above 0 and below 1"):
        evaluate.judge_recognition(ready_library, false_accept_rate=1.0)
    with pytest.raises(NotEnoughLabels, match="Two ready clips"):
        evaluate.judge_recognition(ready_library, ClipFilter(task=("nothing",)))
