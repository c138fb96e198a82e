"""The study of low-dimensional motions (Perera 2009, Table 2): pairs, votes, and the tally."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.openapi import PairId, refusals
from app.api.path_parameters import register_other_than
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.routes.low_dimensional import SVG_ANSWER
from app.api.schemas.studies import (
    PAIRS,
    NewPair,
    NewVote,
    Pair,
    PairList,
    PairsQuery,
    SideQuery,
    StudyTally,
    TallyQuery,
    Vote,
)
from app.api.schemas.views import Motion
from app.api.streams import as_json, as_octets, prefers_octets
from app.errors import AlreadyVoted, ClipNotReady, NotEnoughKeyposes
from app.services.views import studies
from app.services.views.studies import Side
from app.store.database.paging import Page

SIDE = register_other_than("side", "animation.svg", "votes")
router = APIRouter(tags=["studies"])

_BODY = (400, 404, 413, 415)


@router.post(
    PAIRS,
    status_code=201,
    dependencies=[writes, Depends(require_json), heavy],
    responses=refusals(*_BODY, ClipNotReady, NotEnoughKeyposes),
)
def draw_pair(lib: Lib, new: NewPair) -> Pair:
    """Make a pair to compare: two low-dimensional motions of a clip.

    One is made from the clip's keyposes, the other from uniform poses, with the same number of
    dimensions. Which one is on the left is random. Make a new pair for each voter, so that the
    sides balance out.
    """
    return Pair.of(studies.draw_pair(lib, new.clip_id, new.dimensions, new.model_clips))


@router.get(PAIRS, dependencies=[reads, quick], responses=refusals(404))
def list_pairs(lib: Lib, query: Annotated[PairsQuery, Query()]) -> PairList:
    """Pairs, the newest first."""
    page = studies.list_pairs(lib, query.limit, query.cursor)
    items = tuple(Pair.of(pair) for pair in page.items)
    return PairList.model_validate(Page(items, page.next, page.total, page.total_is_exact))


@router.get(PAIRS + "/{pair_id}", dependencies=[reads, quick], responses=refusals(404))
def get_pair(lib: Lib, pair_id: PairId) -> Pair:
    """One pair."""
    return Pair.of(studies.get_pair(lib, pair_id))


@router.delete(
    PAIRS + "/{pair_id}", status_code=204, dependencies=[writes, changes], responses=refusals(404)
)
def delete_pair(lib: Lib, pair_id: PairId) -> None:
    """Delete a pair and the votes on it."""
    studies.delete_pair(lib, pair_id)


@router.get(
    PAIRS + "/{pair_id}/animation.svg",
    dependencies=[reads, heavy],
    response_class=Response,
    responses={200: SVG_ANSWER, **refusals(404, ClipNotReady)},
)
def get_pair_animation(lib: Lib, pair_id: PairId) -> Response:
    """The three motions side by side and synchronous, with the original in the middle (fig. 12)."""
    return Response(studies.animation(lib, pair_id), media_type="image/svg+xml")


@router.get(
    f"{PAIRS}/{{pair_id}}/{{side:{SIDE}}}",
    dependencies=[reads, heavy],
    response_model=Motion,
    responses={200: OCTET_ANSWER, **refusals(404, ClipNotReady)},
)
def get_pair_motion(
    lib: Lib, request: Request, pair_id: PairId, side: Side, query: Annotated[SideQuery, Query()]
) -> Response:
    """The motion on a side, as JSON or octets like `/motion`. It does not show which one it is."""
    view = studies.motion(lib, pair_id, side, query.fps)
    return as_octets(view) if prefers_octets(request) else as_json(view)


@router.post(
    PAIRS + "/{pair_id}/votes",
    status_code=201,
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(*_BODY, AlreadyVoted),
)
def vote(lib: Lib, pair_id: PairId, new: NewVote) -> Vote:
    """Say which side is nearer to the original."""
    vote_id = studies.vote(lib, pair_id, new.choice, new.voter)
    return Vote(id=vote_id, pair_id=pair_id, choice=new.choice)


@router.get(
    "/v1/studies/low-dimensional/tally", dependencies=[reads, quick], responses=refusals(404)
)
def get_tally(lib: Lib, query: Annotated[TallyQuery, Query()]) -> StudyTally:
    """The votes as in Table 2: how many voters chose the motion from keyposes."""
    return StudyTally.of(studies.tally(lib, query.clip_id))
