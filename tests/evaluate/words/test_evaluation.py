"""Words, judged with the labels of a library."""

from __future__ import annotations

import pytest

from app import evaluate
from app.errors import BadField, NotEnoughLabels
from app.services.library.library import Library


def test_the_default_is_compared_with_the_prior(ready_library: Library) -> None:
    words = {row.method: row for row in evaluate.judge_words(ready_library).figures}
    assert words["default"].top_3_recognition >= words["prior"].top_3_recognition


def test_a_library_without_labels_cannot_be_judged(lib: Library) -> None:
    with pytest.raises(NotEnoughLabels):
        evaluate.judge_words(lib)


def test_examples_have_ratios_to_the_nearest_distance(ready_library: Library) -> None:
    (example,) = evaluate.word_examples(ready_library, ["bows"])
    assert example.words == ("bow",)
    ratios = [near.ratio for near in example.nearest]
    assert ratios[0] == pytest.approx(1.0)
    assert ratios == sorted(ratios)
    assert example.nearest[0].carries == ("bow" in example.nearest[0].words)
    usual = evaluate.word_examples(ready_library)
    assert 1 <= len(usual) <= 4
    with pytest.raises(BadField, match="zebra"):
        evaluate.word_examples(ready_library, ["zebra"])


def test_the_curves_are_drawn(ready_library: Library) -> None:
    found = evaluate.judge_words(ready_library)
    assert evaluate.draw_words(found, "svg").startswith(b"<?xml")
