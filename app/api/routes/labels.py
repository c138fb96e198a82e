"""Persons, tasks, words, sources, licenses, metadata and folders of the library, with counts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, quick
from app.api.openapi import refusals
from app.api.path_parameters import register_label
from app.api.schemas.base import PRINTABLE
from app.api.schemas.labels import (
    FolderList,
    FolderQuery,
    LabelPage,
    MetadataKeys,
    NamedCounts,
    WordListQuery,
)
from app.services.clips import discovery, labels, persons
from app.services.recognition import suggestions
from app.store.clips.labels import LabelKind
from app.store.database.paging import Page
from app.store.database.totals import Total

DEFAULT_WORDS, DEFAULT_COMPLETIONS = 1000, 10
"""Limits if the client sends none."""


LABEL = register_label()
router = APIRouter(prefix="/v1", tags=["labels"], responses=refusals(404))


@router.get("/persons", dependencies=[reads, quick])
def list_persons(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Persons, with the number of clips of each."""
    page = labels.page(lib, LabelKind.PERSON, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.delete(
    f"/persons/{{name:{LABEL}}}",
    status_code=204,
    dependencies=[writes, changes],
)
def forget_person(
    lib: Lib,
    name: Annotated[
        str,
        Path(
            max_length=300,
            json_schema_extra=PRINTABLE,
            openapi_examples={"a person": {"value": "PERSON"}},
        ),
    ],
) -> None:
    """Remove a person from all labels, and delete every model that holds the person.

    The person's name also leaves the names, paths, sources, words and metadata of clips, and the
    lists of imported files: `anna_walk.bvh` becomes `anonymous_walk.bvh`. In clips of others, a
    name without a letter leaves only metadata that are nothing but the name. The contents of the
    stored files stay. The models are fitted again in the background. Until then recognition,
    synthesis and `metric-person` answer 409 `model_not_fitted` with `Retry-After`.
    """
    persons.forget_person(lib, name)


@router.get("/tasks", dependencies=[reads, quick])
def list_tasks(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Tasks, with the number of clips of each."""
    page = labels.page(lib, LabelKind.TASK, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.get("/words", dependencies=[reads, quick])
def list_words(lib: Lib, query: Annotated[WordListQuery, Query()]) -> NamedCounts:
    """Words by name, with numbers of clips; or completions of `q`, the likeliest first."""
    if query.q is None:
        page = labels.page(lib, LabelKind.WORD, query.limit or DEFAULT_WORDS, query.cursor)
        return NamedCounts.model_validate(page)
    limit = query.limit or DEFAULT_COMPLETIONS
    found = tuple(suggestions.complete(lib, query.q, limit))
    # A full page may be the first of several, which nobody counts.
    page = Page(found, None).counted(Total(len(found), is_exact=len(found) < limit))
    return NamedCounts.model_validate(page)


@router.get("/sources", dependencies=[reads, quick])
def list_sources(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Sources of clips, with the number of clips from each."""
    page = labels.page(lib, LabelKind.SOURCE, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.get("/licenses", dependencies=[reads, quick])
def list_licenses(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Licenses, with the number of clips of each."""
    page = labels.page(lib, LabelKind.LICENSE, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.get("/metadata", dependencies=[reads, quick])
def list_metadata(lib: Lib, query: Annotated[LabelPage, Query()]) -> MetadataKeys:
    """The keys of the metadata of clips, with the kinds and the most frequent values of each."""
    return MetadataKeys.model_validate(discovery.metadata(lib, query.limit, query.cursor))


@router.get("/folders", dependencies=[reads, quick])
def list_folders(lib: Lib, query: Annotated[FolderQuery, Query()]) -> FolderList:
    """The folders directly in a folder, with the number of clips in and below each.

    A clip that was imported from a folder or a ZIP has the path that its file had there.
    """
    found = discovery.folders(lib, query.folder, query.limit, query.cursor)
    return FolderList.model_validate(found)
