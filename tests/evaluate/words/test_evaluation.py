"""Words, judged with the labels of a library."""

from __future__ import annotations

import pytest

from app import evaluate
from app.errors import BadField, NotEnoughLabels
from app.services.clips.catalogue import list_clips, update_clip
from app.services.library.library import Library


def test_the_default_is_compared_with_the_prior(ready_library: Library) -> None:
    words = {row.method: row for row in evaluate.judge_words(ready_library).figures}
    assert words["default"].top_3_recognition >= words["prior"].top_3_recognition


def test_a_library_without_labels_cannot_be_judged(lib: Library) -> None:
    with pytest.raises(NotEnoughLabels):
        evaluate.judge_words(lib)


def test_examples_have_ratios_to_the_nearest_distance(ready_library: Library) -> None:
    (example,) = evaluate.word_examples(ready_library, ["bows"])
    assert example.words == ("bows",)
    assert example.expanded == {"bows": ("bow",)}
    ratios = [near.ratio for near in example.nearest]
    assert ratios[0] == pytest.approx(1.0)
    distances = [near.distance for near in example.nearest]
    assert distances == sorted(distances)
    assert ratios == sorted(ratios)
    assert example.nearest[0].carries == ("bow" in example.nearest[0].words)
    usual = evaluate.word_examples(ready_library)
    assert 1 <= len(usual) <= 4
    with pytest.raises(BadField, match="zebra"):
        evaluate.word_examples(ready_library, ["zebra"])


def test_a_clip_at_the_query_itself_has_no_ratio_and_synonyms_carry_a_word(
    ready_library: Library,
) -> None:
    """With as many dimensions as words, the space can put a clip exactly at its own words."""
    clips = list_clips(ready_library).items
    for number, clip in enumerate(clips[:6]):
        words = ["march" if number % 2 else "walk"] if number < 4 else ["punch", "strike"]
        update_clip(ready_library, clip.id, {"words": words})
    for clip in clips[6:]:
        update_clip(ready_library, clip.id, {"words": ["sit"]})
    for example in evaluate.word_examples(ready_library, ["punch strike", "parade", "march"]):
        ratios = [near.ratio for near in example.nearest]
        assert all(one is None or 1.0 <= one < 1e6 for one in ratios)
        assert len({one is None for one in ratios}) == 1
    (synonym,) = evaluate.word_examples(ready_library, ["parade"])
    assert synonym.expanded == {"parade": ("march",)}
    assert {near.words for near in synonym.nearest if near.carries} == {("march",)}


def test_the_curves_are_drawn(ready_library: Library) -> None:
    found = evaluate.judge_words(ready_library)
    assert evaluate.draw_words(found, "svg").startswith(b"<?xml")
