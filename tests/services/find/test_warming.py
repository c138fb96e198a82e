"""The first work of a process is done before a search, and changes are loaded as they come."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from app.services.find import find, warming
from app.services.find.queries import WordQuery
from app.services.find.warming import Warmth
from app.services.library.fitted_models import ModelKind
from app.services.library.library import Library
from app.services.training import models
from app.store import models as stored_models
from app.store.clips import repository as stored
from app.store.store import Store
from tests.libraries import work


@pytest.fixture
def opened(ready_library: Library) -> Iterator[Library]:
    """The ready library, opened by another process: nothing is loaded yet."""
    library = Library.open(ready_library.settings)
    library.index.catch_up(library.store)
    yield library
    library.close()


def test_all_kinds_of_searches_are_loaded(opened: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    warmth = Warmth(opened)
    warmth.warm(lambda: False)
    assert warmth.is_warm
    indexes = [opened.paced, opened.segments, opened.poses, opened.word_windows]
    indexes += opened.windows.values()
    assert all(index.is_loaded for index in indexes)
    _no_model_is_read(monkeypatch)
    for mode in warming.WORD_MODES:
        assert find.find_words(opened, WordQuery(["walk"], mode)).items


def _no_model_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    def read(*_: object) -> None:
        raise AssertionError("a model was read")

    monkeypatch.setattr("app.store.models.load_arrays", read)


def test_windows_of_a_large_library_are_left_out(
    opened: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(warming, "MAX_CLIPS", 3)
    Warmth(opened).warm(lambda: False)
    assert opened.poses.is_loaded
    assert not any(index.is_loaded for index in opened.windows.values())


def test_a_stop_leaves_out_the_rest(opened: Library) -> None:
    warmth = Warmth(opened)
    warmth.warm(lambda: True)
    assert not opened.poses.is_loaded
    assert not warmth.is_warm


def test_an_empty_library_needs_no_work(lib: Library) -> None:
    lib.index.catch_up(lib.store)
    warmth = Warmth(lib)
    warmth.warm(lambda: False)
    assert warmth.is_warm
    assert not lib.poses.is_loaded


def test_changes_are_loaded_where_an_index_is(opened: Library) -> None:
    warmth = Warmth(opened)
    warmth.warm(lambda: False)
    before = opened.index.version
    (clip_id, *_) = opened.index.state[1].labels.ids
    with opened.store.write() as tx:
        stored.patch(tx, str(clip_id), {"license": "CC0-1.0"})
    warmth.follow()
    versions = {opened.index.version, opened.poses.version, opened.word_windows.version}
    assert versions == {before + 1}


def test_a_new_model_is_loaded(opened: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    warmth = Warmth(opened)
    warmth.warm(lambda: False)
    old = opened.models.words(opened.store).id
    models.request_fit(opened)
    work(opened.settings)
    warmth.follow()
    assert _current(opened.store) != old
    _no_model_is_read(monkeypatch)
    assert opened.models.words(opened.store).id == _current(opened.store)


def _current(store: Store) -> str:
    with store.read() as tx:
        return stored_models.current_ids(tx)[ModelKind.WORDS.value][0]
