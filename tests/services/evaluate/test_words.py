"""Words, judged on a library's own labels."""

from __future__ import annotations

import pytest

from app.errors import NotEnoughLabels
from app.services import evaluate
from app.services.library import Library


def test_the_default_stands_beside_the_prior(ready_library: Library) -> None:
    words = {row.method: row for row in evaluate.judge_words(ready_library).figures}
    assert words["default"].top_3_recognition >= words["prior"].top_3_recognition


def test_a_library_without_labels_cannot_be_judged(lib: Library) -> None:
    with pytest.raises(NotEnoughLabels):
        evaluate.judge_words(lib)
