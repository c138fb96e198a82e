"""Tables of clips and of annotations that an import reads again."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse

from app.api.deps import Lib, reads_source
from app.api.guard.admission import quick
from app.api.guard.audited import exported
from app.api.openapi import refusals
from app.api.schemas.filters import Filter
from app.search.index.filters import parse_filter
from app.services.annotations.files import export_library
from app.services.clips.manifest_export import manifest

router = APIRouter(prefix="/v1", tags=["labels"], responses=refusals(404))


@router.get(
    "/manifest.csv",
    dependencies=[reads_source, exported, quick],
    response_class=StreamingResponse,
    responses={
        200: {
            "content": {"text/csv": {"schema": {"type": "string"}}},
            "description": "A table with a row for each clip.",
        }
    },
)
def get_manifest(lib: Lib, query: Annotated[Filter, Query()]) -> StreamingResponse:
    """The labels, hints and metadata of clips, as a manifest that an import reads again."""
    filter = parse_filter(query.given())
    return StreamingResponse(
        manifest(lib, filter),
        media_type="text/csv; charset=utf-8",
        headers={"Content-Disposition": 'attachment; filename="manifest.csv"'},
    )


@router.get(
    "/annotations.csv",
    dependencies=[reads_source, exported, quick],
    response_class=StreamingResponse,
    responses={
        200: {
            "content": {"text/csv": {"schema": {"type": "string"}}},
            "description": "A table with a row for each annotation.",
        }
    },
)
def get_annotation_table(lib: Lib, query: Annotated[Filter, Query()]) -> StreamingResponse:
    """The annotations of clips by path, as an `annotations.csv` that an import reads again."""
    return StreamingResponse(
        export_library(lib, parse_filter(query.given())),
        media_type="text/csv; charset=utf-8",
        headers={"Content-Disposition": 'attachment; filename="annotations.csv"'},
    )
