"""Persons, tasks and words of the library, with counts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.api.deps import Lib, reads
from app.api.openapi import refusals
from app.api.schemas.labels import NamedCounts, WordBeginning
from app.services import labels, suggestions

router = APIRouter(prefix="/v1", tags=["labels"], dependencies=[reads], responses=refusals())


@router.get("/persons")
def list_persons(lib: Lib) -> NamedCounts:
    """Persons and how many clips each has."""
    return NamedCounts.of(labels.persons(lib))


@router.get("/tasks")
def list_tasks(lib: Lib) -> NamedCounts:
    """Tasks and how many clips each has."""
    return NamedCounts.of(labels.tasks(lib))


@router.get("/words")
def list_words(lib: Lib, query: Annotated[WordBeginning, Query()]) -> NamedCounts:
    """Words and how many clips carry each, by name; completions of `q`, the likeliest first."""
    if query.q is None:
        return NamedCounts.of(labels.words(lib))
    return NamedCounts.of(suggestions.complete(lib, query.q, query.limit))
