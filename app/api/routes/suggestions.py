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
from app.errors import ClipNotReady, ModelNotFitted, NotEnoughLabels
from app.services.recognition import suggestions

router = APIRouter(prefix="/v1/clips/{clip_id}/word-suggestions", tags=["clips"])

Mode = Annotated[
    Literal["default", "cca", "printed"],
    Query(
        description="As in a search by words: kernel regression (default), or the correlated "
        "space (cca; printed: as in the paper)."
    ),
]
SuggestionLimit = Annotated[int, Query(ge=1, le=suggestions.MAX_SUGGESTED)]


@router.get(
    "",
    dependencies=[reads, heavy],
    responses=refusals(404, ClipNotReady, ModelNotFitted, NotEnoughLabels),
)
def suggest_words(
    lib: Lib, clip_id: ClipId, limit: SuggestionLimit = 10, mode: Mode = "default"
) -> WordSuggestions:
    """Words that the word model suggests for the clip and that the clip does not have yet."""
    return WordSuggestions.of(suggestions.suggest(lib, clip_id, limit, mode))


@router.post(
    "/accept",
    dependencies=[writes, Depends(require_json_if_any), heavy],
    responses=refusals(400, 404, 413, 415, ClipNotReady, ModelNotFitted),
)
def accept_words(lib: Lib, clip_id: ClipId, accepted: AcceptedWords | None = None) -> Clip:
    """Add suggested words to the clip. The next fit learns from them.

    The body names the words. Without a body, all words that are likelier than not are added.
    """
    words = None if accepted is None else accepted.words
    return Clip.model_validate(suggestions.accept(lib, clip_id, words))
