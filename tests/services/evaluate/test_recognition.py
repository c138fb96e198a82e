"""Recognition, judged on a library's own labels."""

from __future__ import annotations

from app.services import evaluate
from app.services.library import Library


def test_the_default_stands_beside_the_prior(ready_library: Library) -> None:
    shares = evaluate.judge_recognition(ready_library)
    assert shares["default"]["task"] >= shares["prior"]["task"]
