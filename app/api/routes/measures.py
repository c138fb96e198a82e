"""The measures of clips, and their values in the library."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.api.deps import Lib, reads
from app.api.guard.admission import quick
from app.api.openapi import refusals
from app.api.schemas.filters import Filter
from app.api.schemas.measures import MeasureList
from app.search.index.filters import parse_filter
from app.services.curation import measures

router = APIRouter(prefix="/v1", tags=["curation"])


@router.get("/measures", dependencies=[reads, quick], responses=refusals())
def list_measures(lib: Lib, query: Annotated[Filter, Query()]) -> MeasureList:
    """The measures of clips, each with unit, definition, and deciles of the library.

    With a filter, `counts` says how the clips that pass it are spread over the deciles.
    """
    found = measures.summaries(lib, parse_filter(query.given()))
    return MeasureList.model_validate({"items": found})
