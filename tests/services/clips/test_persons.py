"""A forgotten person is in no label, no model and no file; a setting switches recognition off."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.demo import DemoClip
from app.errors import ModelBeingFitted, ModelNotFitted, NotFound
from app.services.clips import catalogue as clips
from app.services.clips import jobs, labels, persons
from app.services.clips.anonymize import NameRemover
from app.services.find.find import find_motion
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.imports import imports
from app.services.library.library import Library
from app.services.recognition import recognize
from app.services.recognition.recognize import RecognizeQuery
from app.services.training import models
from app.services.training.fit import fit_library
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState
from app.store.jobs.record import JobKind, JobState
from tests.libraries import settings_for, upload, work

NAME = "Zebulon Quatermain"


def _library(lib: Library, demo: list[DemoClip]) -> dict[str, str]:
    """Two persons' clips, one of them under NAME; clip ids by person and task."""
    ids = {}
    for clip in demo:
        if clip.person in ("ada", "bruno"):
            person = NAME if clip.person == "ada" else clip.person
            made = upload(lib, clip, name=clip.task, person=person).clip
            ids[f"{person} {clip.task}"] = made.id
    models.request_fit(lib)
    work(lib.settings)
    return ids


def _bytes_of(folder: Path) -> bytes:
    return b"".join(path.read_bytes() for path in folder.glob("*.sqlite3*"))


def test_a_forgotten_person_is_in_no_label_model_or_file(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    ids = _library(lib, some_demo_clips)
    theirs = ids[f"{NAME} wave"]
    before = recognize.recognize(lib, RecognizeQuery(QuerySource(theirs)))
    assert NAME in {candidate.label for candidate in before.person.candidates}
    assert NAME.encode() in _bytes_of(lib.settings.data_dir)

    persons.forget_person(lib, NAME)

    assert NAME not in {one.name for one in labels.persons(lib)}
    found = clips.get_clip(lib, theirs)
    assert (found.person, found.state) == (None, ClipState.READY)
    with pytest.raises(
        ModelBeingFitted, match="removed: it held a person who was removed"
    ) as refused:
        recognize.recognize(lib, RecognizeQuery(QuerySource(theirs)))
    (waiting,) = jobs.list_jobs(lib, kind=JobKind.FIT, state=JobState.QUEUED).items
    assert f"try again when the job {waiting.id} has ended" in refused.value.detail
    assert NAME not in refused.value.detail
    lib.store.erase_traces()
    assert NAME.encode() not in _bytes_of(lib.settings.data_dir)

    work(lib.settings)
    after = recognize.recognize(lib, RecognizeQuery(QuerySource(theirs)))
    assert NAME not in {candidate.label for candidate in after.person.candidates}
    assert after.task.candidates[0].label == "wave"
    with pytest.raises(NotFound):
        persons.forget_person(lib, NAME)


def test_a_person_whose_clips_are_deleted_can_be_forgotten(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    ids = _library(lib, some_demo_clips)
    for label, clip_id in ids.items():
        if label.startswith(NAME):
            clips.delete_clip(lib, clip_id)
    query = RecognizeQuery(QuerySource(ids["bruno bow"]))
    held = recognize.recognize(lib, query)
    assert NAME in {candidate.label for candidate in held.person.candidates}

    persons.forget_person(lib, NAME)
    with pytest.raises(ModelBeingFitted):
        recognize.recognize(lib, query)
    lib.store.erase_traces()
    assert NAME.encode() not in _bytes_of(lib.settings.data_dir)
    with pytest.raises(NotFound):
        persons.forget_person(lib, NAME)


def test_the_error_for_a_missing_model_gives_the_reason(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    one = [clip for clip in some_demo_clips if clip.person == "ada"]
    ids = [upload(lib, clip, person=NAME, task="all the same").clip.id for clip in one]
    models.request_fit(lib)
    work(lib.settings)
    query = MotionQuery(QuerySource(ids[0]), method="metric-person")
    with pytest.raises(ModelNotFitted, match="two clips each"):
        find_motion(lib, query)
    models.request_fit(lib)
    with pytest.raises(ModelBeingFitted, match=r"yet\. The models are being fitted: try"):
        find_motion(lib, query)
    persons.forget_person(lib, NAME)
    work(lib.settings)
    with pytest.raises(ModelNotFitted) as refused:
        find_motion(lib, query)
    assert not isinstance(refused.value, ModelBeingFitted)


def test_a_fit_that_began_before_does_not_bring_the_person_back(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    _library(lib, some_demo_clips)
    import app.services.training.fit as fitting

    read = fitting.read_training_set

    def read_then_forget(store: object) -> object:
        training = read(lib.store)
        persons.forget_person(lib, NAME)
        return training

    monkeypatch.setattr(fitting, "read_training_set", read_then_forget)
    outcome = fit_library(lib.store)["models"]
    assert outcome["recognizer"]["outcome"] == "skipped"
    assert outcome["words"]["outcome"] == "fitted"
    assert {record.kind for record in models.list_models(lib)} == {"words", "metric-task"}


def test_no_model_holds_persons_if_recognizing_persons_is_switched_off(
    tmp_path: Path, some_demo_clips: list[DemoClip]
) -> None:
    with_persons = Library.open(settings_for(tmp_path))
    ids = _library(with_persons, some_demo_clips)
    with_persons.close()
    lib = Library.open(settings_for(tmp_path, recognize_persons=False))
    try:
        early = recognize.recognize(lib, RecognizeQuery(QuerySource(ids["bruno bow"])))
        assert (early.person.label, early.person.candidates) == (None, ())
        work(lib.settings)
        found = recognize.recognize(lib, RecognizeQuery(QuerySource(ids["bruno bow"])))
        assert (found.person.label, found.person.candidates) == (None, ())
        assert found.task.candidates[0].label == "bow"
        for record in models.list_models(lib):
            assert "bruno" not in str(record.meta)
    finally:
        lib.close()


def test_whatever_names_a_forgotten_person_is_removed_and_nothing_else(
    lib: Library, some_demo_clips: list[DemoClip], tmp_path: Path
) -> None:
    """The name in names and paths of files, metadata, words, imports; also in clips of others."""
    own, other = some_demo_clips[:2]
    folder = tmp_path / "quatermain in"
    for path, clip in (
        ("Zebulon_Quatermain/ZebulonQuatermain-01.bvh", own),
        ("lab/zebulon quatermain/max_speed.bvh", other),
    ):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(clip.content)
    (folder / "zebulon-quatermain.bvh").write_bytes(b"broken")
    table = (
        "path,person,task,words,partner,note,age\n"
        f"Zebulon_Quatermain/ZebulonQuatermain-01.bvh,{NAME},walk,slow,,,30\n"
        f"lab/zebulon quatermain/max_speed.bvh,Max,walk,slow,{NAME},with zebulon quatermain,31\n"
    )
    (folder / "manifest.csv").write_text(table)
    job = imports.import_path(lib, folder)
    clips.update_clip(
        lib,
        clips.list_clips(lib, ClipFilter(person=(NAME,))).items[0].id,
        {
            "metadata": {"contact": f"{NAME}, room 5", "kept": "room 5"},
            "source": f"studio of {NAME}",
        },
    )
    work(lib.settings)

    persons.forget_person(lib, NAME)

    lib.store.erase_traces()
    stored = _bytes_of(lib.settings.data_dir).lower()
    for trace in (b"zebulon quatermain", b"zebulonquatermain", b"zebulon_quatermain"):
        assert trace not in stored
    found = {clip.path: clip for clip in clips.list_clips(lib).items}
    assert set(found) == {"anonymous/anonymous-01.bvh", "lab/anonymous/max_speed.bvh"}
    theirs = found["anonymous/anonymous-01.bvh"]
    assert (theirs.name, theirs.file_name, theirs.source) == (
        "anonymous-01",
        "anonymous-01.bvh",
        "studio of anonymous",
    )
    assert (theirs.metadata, theirs.words) == ({"age": 30, "kept": "room 5"}, ("slow",))
    of_max = found["lab/anonymous/max_speed.bvh"]
    assert (of_max.person, of_max.name, of_max.metadata) == ("Max", "max_speed", {"age": 31})
    assert {file.path for file in jobs.all_files(lib, job.id)} == {
        "anonymous.bvh",
        "anonymous/anonymous-01.bvh",
        "lab/anonymous/max_speed.bvh",
    }
    assert clips.list_clips(lib, ClipFilter(q="zebulon")).items == ()

    persons.forget_person(lib, "Max")
    kept = {clip.path: clip.name for clip in clips.list_clips(lib).items}
    assert kept["lab/anonymous/max_speed.bvh".replace("max", "anonymous")] == "anonymous_speed"


@pytest.mark.parametrize(
    ("name", "text", "is_in"),
    [
        ("Ann", "anna_walk", False),
        ("Ann", "ANN-walk01", True),
        ("Ann", "walk ann2", True),
        ("02", "02_01.bvh", True),
        ("02", "102_3", False),
        ("02", "take02b", True),
        ("Anna Smith", "anna--smith", True),
        ("Anna Smith", "annasmithers", False),
        ("?!", "what?!", True),
    ],
)
def test_a_name_is_found_as_a_word(name: str, text: str, is_in: bool) -> None:
    remover = NameRemover(name)
    assert remover.holds_name(text) is is_in
    assert (remover.without(text) != text) is is_in
