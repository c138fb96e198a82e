"""The errors for missing models: the reason, and what the client can do."""

from __future__ import annotations

import copy
import functools
from typing import Any

import numpy as np
import pytest

from app.demo import DemoClip
from app.errors import ModelBeingFitted, ModelNotFitted
from app.models.words.library import fit_library_words
from app.services.clips import reanalysis
from app.services.library.library import Library
from app.services.training import models
from app.store import models as stored
from tests.libraries import upload, work
from tests.models.word_clips import word_clips


def test_the_error_for_a_model_of_another_version_says_to_fit_again(lib: Library) -> None:
    meta = {"model": {"version": -1}}
    with lib.store.write() as tx:
        stored.save(tx, "multilinear", meta=meta, arrays={}, library_version=1, library_size=2)
    with pytest.raises(ModelNotFitted, match=r"another version.*POST /v1/models/fit") as refused:
        lib.models.multilinear(lib.store)
    assert not isinstance(refused.value, ModelBeingFitted)
    job = models.request_fit(lib)
    with pytest.raises(ModelBeingFitted, match=f"another version.* job {job.id} has ended"):
        lib.models.multilinear(lib.store)


@pytest.fixture(scope="module")
def fitted_words() -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """The arrays and the metadata of a word model that has all its parts."""
    return fit_library_words(*word_clips(6)).words.to_arrays()


@pytest.mark.parametrize("part", [("model",), ("space",), ("cca", "space"), ("printed", "space")])
def test_a_word_model_with_a_part_of_another_version_gives_the_same_error(
    lib: Library, fitted_words: tuple[dict[str, np.ndarray], dict[str, Any]], part: tuple[str, ...]
) -> None:
    arrays, meta = fitted_words
    meta = copy.deepcopy(meta)
    functools.reduce(dict.__getitem__, part, meta)["version"] = -1
    with lib.store.write() as tx:
        whole = {"model": meta}
        stored.save(tx, "words", meta=whole, arrays=arrays, library_version=1, library_size=2)
    with pytest.raises(ModelNotFitted, match=r"another version of Kinedex.*POST /v1/models/fit"):
        lib.models.words(lib.store)
    job = models.request_fit(lib)
    with pytest.raises(ModelBeingFitted, match=f"another version.* job {job.id} has ended"):
        lib.models.words(lib.store)


def test_during_an_upgrade_the_error_says_that_a_fit_follows(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    meta = {"model": {"version": -1}}
    with lib.store.write() as tx:
        stored.save(tx, "multilinear", meta=meta, arrays={}, library_version=1, library_size=2)
    with monkeypatch.context() as old:
        old.setattr("app.services.clips.ingest.ANALYSIS_VERSION", 0)
        old.setattr("app.services.clips.reanalysis.ANALYSIS_VERSION", 0)
        upload(lib, some_demo_clips[0])
        work(lib.settings)
    upload(lib, some_demo_clips[1])  # a new clip alone does not promise a fit
    with pytest.raises(ModelNotFitted, match="POST /v1/models/fit") as refused:
        lib.models.multilinear(lib.store)
    assert not isinstance(refused.value, ModelBeingFitted)

    assert reanalysis.requeue_outdated(lib) == 1
    for load, reason in (
        (lib.models.multilinear, "another version"),
        (lib.models.synthesis, "No synthesis model"),
    ):
        with pytest.raises(ModelBeingFitted, match=f"{reason}.*without a request.*try again"):
            load(lib.store)


def test_without_a_fit_the_error_says_how_to_fit(lib: Library) -> None:
    with pytest.raises(ModelNotFitted, match=r"No words model .* `kinedex fit`"):
        lib.models.words(lib.store)
    with pytest.raises(ModelNotFitted):
        lib.models.keyposes(lib.store)
