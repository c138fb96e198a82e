"""Annotations come with imports, teach the word model, and forget persons."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.demo import DemoClip
from app.formats.annotations import eaf, table
from app.formats.annotations.span import Span
from app.services.annotations import clip_annotations as kept
from app.services.annotations import files
from app.services.clips import catalogue as clips
from app.services.clips import jobs, persons
from app.services.imports import imports
from app.services.library.library import Library
from app.services.training.training_set import read_training_set
from app.store.clips.clip_annotations import Annotation
from tests.libraries import upload, work
from tests.zip_archives import zip_archive

STEPS = Span(0.25, 1.0, ("step",), "Zoe", "Zoe steps.", "me")


@pytest.fixture
def entries(some_demo_clips: list[DemoClip]) -> dict[str, bytes]:
    """Two clips; one has a file of ELAN, the other has rows of a table."""
    one, other = some_demo_clips[:2]
    return {
        "set/one.bvh": one.content,
        "set/one.eaf": eaf.write_eaf([STEPS]),
        "set/sub/other.bvh": other.content,
        "set/annotations.csv": table.write_table([("sub/other.bvh", STEPS)]),
        "set/lost.eaf": eaf.write_eaf([STEPS]),
    }


def _import(lib: Library, entries: dict[str, bytes]) -> dict[str, str]:
    """The outcome of each file."""
    job = imports.start_import(lib, zip_archive(entries), "set.zip")
    work(lib.settings)
    result = jobs.get_job(lib, job.id).result
    assert result is not None
    return {line["path"]: line["outcome"] for line in result["files"]}


def _said(lib: Library) -> dict[str, list[Annotation]]:
    """The annotations of all clips, by the path of the clip."""
    found = clips.list_clips(lib).items
    return {str(clip.path): list(kept.list_annotations(lib, clip.id)) for clip in found}


def test_annotations_come_with_an_import(lib: Library, entries: dict[str, bytes]) -> None:
    outcomes = _import(lib, entries)
    assert outcomes["set/lost.eaf"] == "skipped"
    said = _said(lib)
    for path in ("set/one.bvh", "set/sub/other.bvh"):
        (one,) = said[path]
        assert files.as_span(one) == STEPS
        assert one.origin == "import"
    # The same again changes nothing; other annotations replace those that nobody edited.
    assert set(_import(lib, entries).values()) == {"unchanged", "skipped"}
    changed = entries | {"set/one.eaf": eaf.write_eaf([replace(STEPS, words=("stride",))])}
    assert _import(lib, changed)["set/one.bvh"] == "updated"
    assert [one.words for one in _said(lib)["set/one.bvh"]] == [("stride",)]
    # An edit stays, and is a conflict.
    (edited,) = _said(lib)["set/sub/other.bvh"]
    kept.change_annotation(lib, edited.clip_id, edited.id, {"words": ["jump"]})
    table_of_others = table.write_table([("sub/other.bvh", replace(STEPS, words=("hop",)))])
    outcomes = _import(lib, changed | {"set/annotations.csv": table_of_others})
    assert outcomes["set/sub/other.bvh"] == "conflicting"
    assert [one.words for one in _said(lib)["set/sub/other.bvh"]] == [("jump",)]


def test_a_bad_file_of_annotations_is_reported_and_its_clip_is_stored(
    lib: Library, entries: dict[str, bytes]
) -> None:
    outcomes = _import(lib, entries | {"set/one.eaf": b"<ANNOTATION_DOCUMENT>"})
    assert outcomes["set/one.eaf"] == "failed"
    assert outcomes["set/one.bvh"] == "ready"
    assert _said(lib)["set/one.bvh"] == []


def test_a_table_of_the_library_is_imported_again(lib: Library, entries: dict[str, bytes]) -> None:
    _import(lib, entries)
    for (one,) in _said(lib).values():
        kept.change_annotation(lib, one.clip_id, one.id, {"words": ["jump"]})
    exported = b"".join(files.export_library(lib))
    for (one,) in _said(lib).values():
        kept.replace_annotations(lib, one.clip_id, [])
    del entries["set/one.eaf"], entries["set/annotations.csv"]
    _import(lib, entries | {"annotations.csv": exported})
    jumps = replace(STEPS, words=("jump",))
    assert {path: [files.as_span(one) for one in some] for path, some in _said(lib).items()} == {
        "set/one.bvh": [jumps],
        "set/sub/other.bvh": [jumps],
    }


def test_a_person_is_forgotten_in_annotations_too(lib: Library, entries: dict[str, bytes]) -> None:
    _import(lib, entries)
    persons.forget_person(lib, "Zoe")
    for (one,) in _said(lib).values():
        assert (one.person, one.text, one.words) == (None, None, ("step",))


def test_parts_with_words_teach_in_place_of_their_clip(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    first, second = (upload(lib, clip).clip for clip in some_demo_clips[:2])
    work(lib.settings)
    before = read_training_set(lib.store)
    number = [clip.id for clip in before.clips].index(first.id)
    assert before.label_sets[number]
    assert before.tasks[number] is not None
    assert len(before.spans) == 0
    parts = [
        {"start": 0.0, "end": 1.0, "words": ["first"], "text": "Somebody walks."},
        {"start": 1.0, "end": 1.8, "words": ["second"], "person": "Zoe"},
        {"start": 0.0, "end": 1.0, "text": "no words"},
    ]
    kept.replace_annotations(lib, first.id, parts)
    after = read_training_set(lib.store)
    assert after.label_sets[number] == ()
    assert after.tasks[number] is None
    other = [clip.id for clip in after.clips].index(second.id)
    assert after.label_sets[other] == before.label_sets[other]
    taught = after.taught_parts
    assert taught.inputs.shape == (2, after.word_inputs.shape[1])
    assert taught.label_sets[0][0] == "first"
    assert "walk" in taught.label_sets[0]
    assert taught.label_sets[1] == ("second",)
    assert taught.groups == [after.groups[number]] * 2
    assert taught.persons[0] != taught.persons[1]
