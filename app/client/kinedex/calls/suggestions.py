"""Calls: suggestions. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from kinedex.call import Call, path_of, record
from kinedex.sent import UNSET, given

if TYPE_CHECKING:
    from kinedex.types.clips import Clip
    from kinedex.types.labels import WordSuggestions


def suggest_words(
    clip_id: str,
    *,
    limit: int | None = None,
    mode: Literal["default", "cca", "printed"] | None = None,
) -> Call[WordSuggestions]:
    """Words that the word model suggests for the clip and that the clip does not have yet.

    limit: Default: 10.
    mode: As in a search by words: kernel regression (default), or the correlated space (cca;
        printed: as in the paper). Default: default.
    """
    from kinedex.types.labels import WordSuggestions

    return Call(
        "suggest_words",
        "GET",
        path_of("/v1/clips/{clip_id}/word-suggestions", clip_id=clip_id),
        record(WordSuggestions),
        query=given(limit=limit, mode=mode),
    )


def accept_words(clip_id: str, *, words: Sequence[str] | None = None) -> Call[Clip]:
    """Add suggested words to the clip. The next fit learns from them.

    The body names the words. Without a body, all words that are likelier than not are added.

    words: Words to add to the clip. Default: all suggestions that are likelier than not.
    """
    from kinedex.types.clips import Clip

    return Call(
        "accept_words",
        "POST",
        path_of("/v1/clips/{clip_id}/word-suggestions/accept", clip_id=clip_id),
        record(Clip),
        json=given(words=words) or UNSET,
    )
