"""Signatures of models that were replaced, are not needed or cannot be used."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.analysis.descriptors.motion_sample import SAMPLE_LENGTH
from app.errors import BadField, ModelNotFitted, NoSignatures, NotFound
from app.models.recognition.multilinear import fit_multilinear
from app.services.library.library import Library
from app.services.recognition.signatures import eigenmotion, signatures
from app.store import models
from tests.models.factor_clips import factor_clips


def save(lib: Library, kind: str = "multilinear") -> str:
    clips = factor_clips(width=SAMPLE_LENGTH, takes=1)
    arrays, meta = fit_multilinear(clips.samples, clips.persons, clips.tasks).to_arrays()
    with lib.store.write() as tx:
        saved = models.save(
            tx, kind, meta={"model": meta}, arrays=arrays, library_version=1, library_size=30
        )
    return saved.id


def test_a_library_without_clips_still_shows_its_model(lib: Library) -> None:
    found = signatures(lib, save(lib))
    assert found.persons.names == ("p0", "p1", "p2", "p3", "p4")
    assert (found.clips.items, found.clips.next, found.clips.total) == ((), None, 0)


def test_a_replaced_model_is_not_found_and_the_new_one_is_named(lib: Library) -> None:
    old, new = save(lib), save(lib)
    with pytest.raises(NotFound, match=f"version 2 of multilinear: {new}"):
        signatures(lib, old)
    assert signatures(lib, new).record.id == new


def test_other_kinds_have_no_signatures(lib: Library) -> None:
    with pytest.raises(NoSignatures, match="A perera model has no signatures"):
        eigenmotion(lib, save(lib, "perera"), 1)


def test_models_of_persons_can_be_switched_off(lib: Library) -> None:
    model_id = save(lib)
    off = replace(lib, settings=lib.settings.model_copy(update={"recognize_persons": False}))
    with pytest.raises(ModelNotFitted, match="switched off"):
        signatures(off, model_id)
    with pytest.raises(ModelNotFitted, match="switched off"):
        eigenmotion(off, model_id, 1)


def test_eigenmotions_have_bounds(lib: Library) -> None:
    model_id = save(lib)
    assert eigenmotion(lib, model_id, 1, seconds=0.5).positions.shape == (15, 13, 3)
    for wrong in ({"deviations": 6.1}, {"deviations": float("nan")}, {"seconds": 0.1}):
        with pytest.raises(BadField):
            eigenmotion(lib, model_id, 1, **wrong)
    for number in (0, 101):
        with pytest.raises(NotFound):
            eigenmotion(lib, model_id, number)
