"""Calls: studies. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinedex.call import OCTETS, Call, nothing, path_of, record, text
from kinedex.positions import Positions, positions
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.choices import Choice, Side
    from kinedex.types.studies import Pair, PairList, StudyTally, Vote
    from kinedex.types.views import Motion


def list_pairs(*, limit: int | None = None, cursor: str | None = None) -> Call[PairList]:
    """Pairs, the newest first.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.studies import PairList

    return Call(
        "list_pairs",
        "GET",
        "/v1/studies/low-dimensional/pairs",
        record(PairList),
        query=given(limit=limit, cursor=cursor),
    )


def draw_pair(
    clip_id: str, *, dimensions: int | None = None, model_clips: Sequence[str] | None = None
) -> Call[Pair]:
    """Make a pair to compare: two low-dimensional motions of a clip.

    One is made from the clip's keyposes, the other from uniform poses, with the same number of
    dimensions. Which one is on the left is random. Make a new pair for each voter, so that the
    sides balance out.

    dimensions: Dimensions of both versions, up to the number of poses of the model. Default: 3.
    model_clips: Clips with the poses of the models. Default: the clip itself.
    """
    from kinedex.types.studies import Pair

    return Call(
        "draw_pair",
        "POST",
        "/v1/studies/low-dimensional/pairs",
        record(Pair),
        json=given(clip_id=clip_id, dimensions=dimensions, model_clips=model_clips),
    )


def get_pair(pair_id: str) -> Call[Pair]:
    """One pair."""
    from kinedex.types.studies import Pair

    return Call(
        "get_pair",
        "GET",
        path_of("/v1/studies/low-dimensional/pairs/{pair_id}", pair_id=pair_id),
        record(Pair),
    )


def delete_pair(pair_id: str) -> Call[None]:
    """Delete a pair and the votes on it."""
    return Call(
        "delete_pair",
        "DELETE",
        path_of("/v1/studies/low-dimensional/pairs/{pair_id}", pair_id=pair_id),
        nothing,
    )


def get_pair_animation(pair_id: str) -> Call[str]:
    """The three motions side by side and synchronous, with the original in the middle (fig. 12)."""
    return Call(
        "get_pair_animation",
        "GET",
        path_of("/v1/studies/low-dimensional/pairs/{pair_id}/animation.svg", pair_id=pair_id),
        text,
        accept="*/*",
    )


def get_pair_motion(pair_id: str, side: Side, *, fps: float | None = None) -> Call[Motion]:
    """The motion on a side, as JSON or octets like `/motion`. It does not show which one it is.

    fps: The motion is resampled to this rate. Default: 30, its own rate.
    """
    from kinedex.types.views import Motion

    return Call(
        "get_pair_motion",
        "GET",
        path_of("/v1/studies/low-dimensional/pairs/{pair_id}/{side}", pair_id=pair_id, side=side),
        record(Motion),
        query=given(fps=fps),
    )


def get_pair_motion_array(pair_id: str, side: Side, *, fps: float | None = None) -> Call[Positions]:
    """The motion on a side, as JSON or octets like `/motion`. It does not show which one it is. The
    answer is an array.

    fps: The motion is resampled to this rate. Default: 30, its own rate.
    """
    return Call(
        "get_pair_motion",
        "GET",
        path_of("/v1/studies/low-dimensional/pairs/{pair_id}/{side}", pair_id=pair_id, side=side),
        positions,
        query=given(fps=fps),
        accept=OCTETS,
    )


def vote(pair_id: str, choice: Choice, *, voter: str | None = None) -> Call[Vote]:
    """Say which side is nearer to the original.

    voter: A text that identifies the voter, for example a random number. Each voter has one vote
        on a sequence. Only a hash of it is stored.
    """
    from kinedex.types.studies import Vote

    return Call(
        "vote",
        "POST",
        path_of("/v1/studies/low-dimensional/pairs/{pair_id}/votes", pair_id=pair_id),
        record(Vote),
        json=given(choice=choice, voter=voter),
    )


def get_tally(clip_id: str | None = None) -> Call[StudyTally]:
    """The votes as in Table 2: how many voters chose the motion from keyposes.

    clip_id: Only votes on pairs of this clip.
    """
    from kinedex.types.studies import StudyTally

    return Call(
        "get_tally",
        "GET",
        "/v1/studies/low-dimensional/tally",
        record(StudyTally),
        query=given(clip_id=clip_id),
    )
