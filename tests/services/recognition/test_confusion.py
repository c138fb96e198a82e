"""Confusions that a fit has stored, when clips are gone, and of a fit that stored none."""

from __future__ import annotations

import pytest

from app.demo import DemoClip
from app.errors import ModelNotFitted
from app.models.held_out.recognition import Guess
from app.services.clips.catalogue import delete_clip
from app.services.library.guessed_labels import guess_arrays
from app.services.library.library import Library
from app.services.recognition.confusion import Cell, confused_clips, confusion
from app.store import models
from tests.libraries import upload

GUESSES: list[Guess] = [("bo", "kick"), ("bo", "hop"), ("bo", "kick")]


def _save(lib: Library, ids: list[str]) -> None:
    arrays, meta = guess_arrays(ids, ["ada", None, "bo"], ["kick", "kick", "hop"], GUESSES)
    with lib.store.write() as tx:
        models.save(
            tx,
            "recognizer",
            meta={"model": meta},
            arrays=arrays,
            library_version=1,
            library_size=len(ids),
        )


def test_it_counts_labels_and_guesses_and_finds_their_clips(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    ids = [upload(lib, clip).clip.id for clip in some_demo_clips[:3]]
    _save(lib, ids)
    assert confusion(lib, "person")[1] == [Cell("ada", "bo", 1), Cell("bo", "bo", 1)]
    assert confusion(lib, "task")[1] == [
        Cell("hop", "kick", 1),
        Cell("kick", "hop", 1),
        Cell("kick", "kick", 1),
    ]
    assert [c.id for c in confused_clips(lib, "task", "kick", "hop", 10)] == [ids[1]]
    delete_clip(lib, ids[1])
    assert confused_clips(lib, "task", "kick", "hop", 10) == ()


def test_a_model_without_guesses_has_to_be_fitted_again(lib: Library) -> None:
    assert guess_arrays(["a"], ["ada"], ["kick"], []) == ({}, {})
    with lib.store.write() as tx:
        models.save(
            tx, "recognizer", meta={"model": {}}, arrays={}, library_version=1, library_size=1
        )
    with pytest.raises(ModelNotFitted):
        confusion(lib, "task")
