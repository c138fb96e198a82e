"""The map of all motions."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.api.deps import Lib, reads
from app.api.guard.admission import heavy
from app.api.openapi import refusals
from app.api.schemas.space import SpaceColumns, SpaceMap, SpaceQuery
from app.errors import ModelNotFitted
from app.services.find import map as space

router = APIRouter(prefix="/v1/space", tags=["search"], dependencies=[reads])


@router.get("", dependencies=[heavy], responses=refusals(ModelNotFitted))
def get_space(lib: Lib, query: Annotated[SpaceQuery, Query()]) -> SpaceMap:
    """Every ready clip as a point in two or three dimensions. Similar clips are close together."""
    found = space.draw_map(lib, query.space, query.dimensions, query.as_filter(), query.limit)
    return SpaceMap.of(query, found)


@router.get("/columns", dependencies=[heavy], responses=refusals(ModelNotFitted))
def get_space_columns(lib: Lib, query: Annotated[SpaceQuery, Query()]) -> SpaceColumns:
    """The same map as columns of numbers, to draw very many clips: each value is written once."""
    found = space.place_clips(lib, query.space, query.dimensions, query.as_filter(), query.limit)
    return SpaceColumns.of(query, found)
