"""Recognition of person, task and words by models that a worker has fitted."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import pytest

from app.demo import DemoClip, demo_clips
from app.errors import BadField, ModelNotFitted
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.recognition import recognize
from app.services.recognition.recognize import METHODS, RecognizeQuery
from app.services.training import models
from app.services.training.active_errors import active_errors
from app.store.jobs.record import JobKind, JobState
from app.store.jobs.repository import list_jobs
from tests.libraries import FindClip, settings_for, upload, work


@pytest.mark.parametrize("method", METHODS)
def test_a_stored_clip_is_recognized(
    ready_library: Library, clip_of: FindClip, method: str
) -> None:
    query = RecognizeQuery(QuerySource(clip_of("ada", "wave").id), method=method)
    found = recognize.recognize(ready_library, query)
    assert found.task.candidates[0].label == "wave"
    assert found.person.candidates[0].label == "ada"
    assert found.calibrated is (method in ("default", "perera"))
    scores = [score for _, score in found.words]
    assert "wave" in dict(found.words)
    assert scores == sorted(scores, reverse=True)


def test_a_library_with_one_label_says_that_nothing_could_be_held_out(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    for clip in demo_clips(["ada"], ["walk"], takes=2):
        upload(lib, clip)
    models.request_fit(lib)
    work(lib.settings)
    stranger = next(c for c in some_demo_clips if (c.person, c.task) == ("chika", "kick"))
    for method in ("default", "perera"):
        source = QuerySource(content=io.BytesIO(stranger.content))
        found = recognize.recognize(lib, RecognizeQuery(source, method=method))
        assert not found.calibrated
        assert [warning.split()[1] for warning in found.warnings] == ["person", "task"]


def test_a_known_person_or_task_is_the_answer(ready_library: Library, clip_of: FindClip) -> None:
    query = RecognizeQuery(
        QuerySource(clip_of("ada", "wave").id), known_person="ada", known_task=" wave "
    )
    found = recognize.recognize(ready_library, query)
    assert (found.person.label, found.task.label) == ("ada", "wave")


def test_an_upload_is_recognized_as_its_stored_twin(
    ready_library: Library, some_demo_clips: list[DemoClip], clip_of: FindClip
) -> None:
    demo = next(c for c in some_demo_clips if (c.person, c.task) == ("chika", "bow"))
    theirs = recognize.recognize(
        ready_library, RecognizeQuery(QuerySource(content=io.BytesIO(demo.content)))
    )
    ours = recognize.recognize(
        ready_library, RecognizeQuery(QuerySource(clip_of("chika", "bow").id))
    )
    assert theirs.task.candidates[0].label == ours.task.candidates[0].label == "bow"
    assert theirs.words[0] == pytest.approx(ours.words[0])


@pytest.mark.parametrize("mode", ["cca", "printed"])
def test_words_of_an_upload_and_of_a_part_are_predicted_in_a_correlated_space(
    ready_library: Library, some_demo_clips: list[DemoClip], clip_of: FindClip, mode: str
) -> None:
    demo = next(c for c in some_demo_clips if (c.person, c.task) == ("chika", "bow"))
    stored = QuerySource(clip_of("chika", "bow").id)
    sent = QuerySource(content=io.BytesIO(demo.content))
    theirs, ours = (
        recognize.recognize(ready_library, RecognizeQuery(source, word_mode=mode)).words
        for source in (sent, stored)
    )
    assert theirs[0] == pytest.approx(ours[0])
    assert "bow" in dict(ours)  # words that the clip carries are predicted too
    part = replace(stored, start=0.2, end=1.0)
    assert recognize.recognize(ready_library, RecognizeQuery(part, word_mode=mode)).words
    with pytest.raises(BadField, match="word_mode"):
        recognize.recognize(ready_library, RecognizeQuery(stored, word_mode="guess"))


def test_an_unknown_method_is_refused(ready_library: Library, clip_of: FindClip) -> None:
    with pytest.raises(BadField, match="method"):
        recognize.recognize(
            ready_library, RecognizeQuery(QuerySource(clip_of("ada", "bow").id), method="x")
        )


def test_models_have_their_library_size_and_held_out_figures(
    ready_library: Library,
) -> None:
    fitted = {record.kind: record for record in models.list_models(ready_library)}
    kinds = {"words", "recognizer", "multilinear", "metric-task", "metric-person", "synthesis"}
    kinds |= {"signatures", "perera"}
    assert set(fitted) == kinds
    assert {record.library_size for record in fitted.values()} == {12}
    words = {row["method"]: row for row in fitted["words"].meta["figures"]["figures"]}
    assert words["default"]["top_3_recognition"] >= words["prior"]["top_3_recognition"]
    assert "default" in fitted["recognizer"].meta["figures"]["held_out"]


def test_a_model_that_cannot_be_fitted_is_skipped_with_its_reason(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    for demo in some_demo_clips[:3]:
        upload(lib, demo, person=None, task=None)
    job = models.request_fit(lib)
    assert models.request_fit(lib).id == job.id
    work(lib.settings)
    with lib.store.read() as tx:
        (done,) = list_jobs(tx, kind=JobKind.FIT).items
    assert done.state is JobState.SUCCEEDED
    assert done.result is not None
    outcomes = done.result["models"]
    assert outcomes["words"]["outcome"] == "fitted"
    assert outcomes["recognizer"]["outcome"] == outcomes["multilinear"]["outcome"] == "skipped"
    assert outcomes["recognizer"]["reason"]
    clip = upload(lib, some_demo_clips[0]).clip
    with pytest.raises(ModelNotFitted):
        recognize.recognize(lib, RecognizeQuery(QuerySource(clip.id)))


def test_a_lower_false_accept_rate_takes_effect_at_once_and_stays_after_a_fit(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    for clip in some_demo_clips:
        upload(lib, clip)
    models.request_fit(lib)
    work(lib.settings)
    (record,) = (r for r in models.list_models(lib) if r.kind == "recognizer")
    curve = record.meta["figures"]["unknown"]["person"]["curve"]
    assert {"threshold", "false_acceptance", "false_rejection"} == set(curve[0])
    threshold = lib.models.recognizer(lib.store).model.person_calibration.threshold

    changed = models.set_false_accept_rate(lib, record.id, 0.001)
    assert changed.settings == {"false_accept_rate": 0.001}
    strict = lib.models.recognizer(lib.store).model.person_calibration
    assert strict.error_rates()[0] == 0.0
    assert strict.threshold <= threshold
    errors = active_errors(lib, changed)
    assert errors is not None
    person = errors["person"]
    assert (person.threshold, person.false_acceptance) == (strict.threshold, 0.0)
    assert person.false_rejection == strict.error_rates()[1]
    usual = changed.meta["figures"]["unknown"]["person"]
    assert person.false_rejection >= usual["false_rejection"]

    models.request_fit(lib)
    work(lib.settings)
    (again,) = (r for r in models.list_models(lib) if r.kind == "recognizer")
    assert again.settings == changed.settings
    assert models.set_false_accept_rate(lib, again.id, None).settings == {}

    (perera,) = (r for r in models.list_models(lib) if r.kind == "perera")
    assert perera.meta["figures"]["unknown"]["task"]["curve"]
    models.set_false_accept_rate(lib, perera.id, 0.001)
    assert lib.models.perera(lib.store).model.task_calibration.error_rates()[0] == 0.0

    (words,) = (r for r in models.list_models(lib) if r.kind == "words")
    for model_id, rate in ((words.id, 0.1), (again.id, 0.0), (again.id, 1.0)):
        with pytest.raises(BadField, match="false_accept_rate"):
            models.set_false_accept_rate(lib, model_id, rate)


@pytest.mark.parametrize("method", sorted(set(METHODS) - {"default"}))
def test_methods_that_need_persons_are_refused_if_recognizing_is_switched_off(
    ready_library: Library, clip_of: FindClip, method: str
) -> None:
    closed = replace(
        ready_library, settings=settings_for(Path("/nowhere"), recognize_persons=False)
    )
    with pytest.raises(ModelNotFitted, match="switched off"):
        recognize.recognize(
            closed, RecognizeQuery(QuerySource(clip_of("ada", "wave").id), method=method)
        )
