"""Words suggested for a clip."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Query

from app.api.bodies import require_json_if_any
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.schemas.clips import Clip
from app.api.schemas.labels import AcceptedWords, WordSuggestions
from app.services.recognition import suggestions

router = APIRouter(prefix="/v1/clips/{clip_id}/word-suggestions", tags=["clips"])

Mode = Annotated[
    Literal["default", "cca"],
    Query(description="As of a search by words: kernel regression, or Takano's correlated space."),
]
Most = Annotated[int, Query(ge=1, le=suggestions.MAX_SUGGESTED)]


@router.get("", dependencies=[reads, heavy], responses=refusals(404, 409))
def suggest_words(
    lib: Lib, clip_id: ClipId, limit: Most = 10, mode: Mode = "default"
) -> WordSuggestions:
    """Words that the clip does not carry and that the word model would give it."""
    return WordSuggestions.of(suggestions.suggest(lib, clip_id, limit, mode))


@router.post(
    "/accept",
    dependencies=[writes, Depends(require_json_if_any), heavy],
    responses=refusals(400, 404, 409, 413, 415),
)
def accept_words(lib: Lib, clip_id: ClipId, accepted: AcceptedWords | None = None) -> Clip:
    """Give the clip suggested words, those named or all likely ones; the next fit learns them.

    Without a body, all likely ones.
    """
    words = None if accepted is None else accepted.words
    return Clip.model_validate(suggestions.accept(lib, clip_id, words))
