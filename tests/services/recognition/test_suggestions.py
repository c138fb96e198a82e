"""Words that the model predicts for a clip are suggested, and accepted in one call."""

from __future__ import annotations

import pytest

from app.demo import DemoClip
from app.errors import BadField, ModelNotFitted
from app.services.clips import catalogue as clips
from app.services.library.library import Library
from app.services.recognition import suggestions
from app.services.training import models
from tests.libraries import FindClip, upload, work


def test_words_that_a_clip_carries_are_not_suggested(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("ada", "walk")
    found = suggestions.suggest(ready_library, clip.id, limit=100)
    assert not {word for word, _ in found} & set(clip.words)
    assert [score for _, score in found] == sorted((s for _, s in found), reverse=True)


def test_a_clip_without_words_gets_words_of_similar_clips_and_the_next_fit_learns_them(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    *labelled, last = [clip for clip in some_demo_clips if clip.task in ("walk", "kick")]
    for clip in labelled:
        upload(lib, clip)
    bare = upload(lib, last, words=()).clip
    work(lib.settings)
    with pytest.raises(ModelNotFitted):
        suggestions.suggest(lib, bare.id)
    models.request_fit(lib)
    work(lib.settings)

    words = [word for word, _ in suggestions.suggest(lib, bare.id)]
    assert set(last.words) & set(words[:3])
    through_space = suggestions.suggest(lib, bare.id, 3, "cca")
    assert set(last.words) & {word for word, _ in through_space}
    assert all(0.0 < score < 1.0 for _, score in through_space)
    accepted = suggestions.accept(lib, bare.id, [words[0]])
    assert accepted.words == (words[0],)
    assert words[0] not in dict(suggestions.suggest(lib, bare.id))
    likely = suggestions.accept(lib, bare.id)
    assert likely.words[0] == words[0]
    assert clips.get_clip(lib, bare.id).words == likely.words

    models.request_fit(lib)
    work(lib.settings)
    carried = lib.models.words(lib.store).model.vocabulary.words
    assert words[0] in carried


def test_a_word_is_completed(ready_library: Library) -> None:
    assert suggestions.complete(ready_library, "WA")[0].name.startswith("wa")
    assert suggestions.complete(ready_library, "zzz") == []
    assert suggestions.complete(ready_library, "Walking")[0].name == "walk"
    assert len(suggestions.complete(ready_library, "", limit=2)) == 2


def test_a_wrong_limit_is_refused(ready_library: Library, clip_of: FindClip) -> None:
    with pytest.raises(BadField):
        suggestions.suggest(ready_library, clip_of("ada", "walk").id, limit=0)
    with pytest.raises(BadField):
        suggestions.suggest(ready_library, clip_of("ada", "walk").id, mode="guess")
