"""Persons, tasks and words of the library, with counts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query
from starlette.convertors import PathConvertor, register_url_convertor

from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, quick
from app.api.openapi import refusals
from app.api.schemas.labels import LabelPage, NamedCounts, WordBeginning
from app.services.clips import labels, persons
from app.services.recognition import suggestions
from app.store.clips.labels import LabelKind

MOST_WORDS, MOST_COMPLETIONS = 1000, 10
"""Where a client does not say how many."""


class LabelConvertor(PathConvertor):
    """The rest of a path, whatever it holds: labels may hold slashes, also at their end.

    Unlike Starlette's `path` it takes line ends, to be refused as part of a label, and not
    nothing at all, which is the list's address.
    """

    regex = "(?s:.+)"


register_url_convertor("label", LabelConvertor())
router = APIRouter(prefix="/v1", tags=["labels"], dependencies=[reads], responses=refusals())


@router.get("/persons", dependencies=[quick])
def list_persons(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Persons and how many clips each has."""
    page = labels.page(lib, LabelKind.PERSON, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.delete(
    "/persons/{name:label}",
    status_code=204,
    dependencies=[writes, changes],
    responses=refusals(404),
)
def forget_person(lib: Lib, name: Annotated[str, Path(max_length=300)]) -> None:
    """Take a person's label from all clips, and remove every model that holds them at once;
    they are fitted anew in the background, and until then recognition, synthesis and
    `metric-person` answer 409 `model_not_fitted` with `Retry-After`. The clips stay, and so do
    names of files."""
    persons.forget_person(lib, name)


@router.get("/tasks", dependencies=[quick])
def list_tasks(lib: Lib, query: Annotated[LabelPage, Query()]) -> NamedCounts:
    """Tasks and how many clips each has."""
    page = labels.page(lib, LabelKind.TASK, query.limit, query.cursor)
    return NamedCounts.model_validate(page)


@router.get("/words", dependencies=[quick])
def list_words(lib: Lib, query: Annotated[WordBeginning, Query()]) -> NamedCounts:
    """Words and how many clips carry each, by name; completions of `q`, the likeliest first."""
    if query.q is None:
        page = labels.page(lib, LabelKind.WORD, query.limit or MOST_WORDS, query.cursor)
        return NamedCounts.model_validate(page)
    found = suggestions.complete(lib, query.q, query.limit or MOST_COMPLETIONS)
    return NamedCounts.model_validate({"items": found})
