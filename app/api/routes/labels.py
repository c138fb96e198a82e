"""Persons, tasks and words of the library, with counts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query
from starlette.convertors import PathConvertor, register_url_convertor

from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, quick
from app.api.openapi import refusals
from app.api.schemas.labels import LabelPage, NamedCounts, WordListQuery
from app.services.clips import labels, persons
from app.services.recognition import suggestions
from app.store.clips.labels import LabelKind
from app.store.database.paging import Page
from app.store.database.totals import Total

DEFAULT_WORDS, DEFAULT_COMPLETIONS = 1000, 10
"""Limits if the client sends none."""


class LabelConvertor(PathConvertor):
    """The rest of a path as one label. A label may hold slashes, also at its end.

    Starlette's `path` refuses line ends and accepts an empty rest. Here, a line end is part of the
    label, so that the check of labels can refuse it. An empty rest is refused, because it is the
    path of the list.
    """

    regex = "(?s:.+)"


register_url_convertor("label", LabelConvertor())
router = APIRouter(prefix="/v1", tags=["labels"], dependencies=[reads], responses=refusals())


@router.get("/persons", dependencies=[quick])
def list_persons(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Persons, with the number of clips of each."""
    page = labels.page(lib, LabelKind.PERSON, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.delete(
    "/persons/{name:label}",
    status_code=204,
    dependencies=[writes, changes],
    responses=refusals(404),
)
def forget_person(
    lib: Lib,
    name: Annotated[str, Path(max_length=300, openapi_examples={"a person": {"value": "PERSON"}})],
) -> None:
    """Remove a person's label from all clips, and delete every model that holds the person.

    The models are fitted again in the background. Until then recognition, synthesis and
    `metric-person` answer 409 `model_not_fitted` with `Retry-After`. The clips and the names of
    their files stay.
    """
    persons.forget_person(lib, name)


@router.get("/tasks", dependencies=[quick])
def list_tasks(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Tasks, with the number of clips of each."""
    page = labels.page(lib, LabelKind.TASK, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.get("/words", dependencies=[quick])
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
