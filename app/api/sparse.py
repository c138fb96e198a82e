"""Sparse answers: `fields=` chooses the members that a clip, or each clip of a list, has.

Only the chosen members are checked and written. `hit_pages` does the same for hits.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any

from fastapi import Query, Response
from pydantic import BaseModel, create_model

from app.api.schemas.base import Fields, Outgoing
from app.errors import BadField
from app.kinedex_error import Place

ChosenFields = Annotated[Fields | None, Query()]
CACHED = 256
"""Combinations of fields whose model is kept. Making a model takes about 1 ms."""


def sparse_item(model: type[BaseModel], names: list[str], value: object) -> Response:
    """Return the chosen members of one item as JSON. Raises BadField for an unknown name."""
    return _written(_sparse(model, frozenset(names)), value)


def sparse_page(page: type[BaseModel], names: list[str], value: object) -> Response:
    """Return a page whose `items` have only the chosen members. Raises BadField."""
    return _written(_sparse_page(page, frozenset(names)), value)


def refuse_unknown(model: type[BaseModel], names: frozenset[str]) -> None:
    """Raise BadField if a name is no member of a model, or of a model in it (`clip.id`)."""
    for name in sorted(names):
        outer, dot, inner = name.partition(".")
        field = model.model_fields.get(outer)
        kind = None if field is None else field.annotation
        if field is not None and not dot:
            continue
        if not inner or not isinstance(kind, type) or not issubclass(kind, BaseModel):
            raise _unknown(name, model)
        refuse_unknown(kind, frozenset({inner}))


def _written(model: type[BaseModel], value: object) -> Response:
    # FastAPI does not write this answer, because it would check it against whole items.
    content = model.model_validate(value, from_attributes=True).model_dump_json()
    return Response(content, media_type="application/json")


@lru_cache(CACHED)
def _sparse_page(page: type[BaseModel], names: frozenset[str]) -> type[BaseModel]:
    (item,) = page.model_fields["items"].annotation.__args__  # type: ignore[union-attr]
    sparse: Any = list[_sparse(item, names)]  # type: ignore[misc]
    return create_model(page.__name__, __base__=page, items=(sparse, ...))


@lru_cache(CACHED)
def _sparse(model: type[BaseModel], names: frozenset[str]) -> type[BaseModel]:
    refuse_unknown(model, names)
    fields: dict[str, Any] = {}
    for name, field in model.model_fields.items():
        inner = frozenset(one.partition(".")[2] for one in names if one.startswith(f"{name}."))
        kind = field.annotation
        if name in names:
            fields[name] = (kind, field)
        elif inner and isinstance(kind, type) and issubclass(kind, BaseModel):
            fields[name] = (_sparse(kind, inner), field)
    return create_model(f"{model.__name__}Fields", __base__=Outgoing, **fields)


def _unknown(name: str, model: type[BaseModel]) -> BadField:
    known = ", ".join(model.model_fields)
    message = f"{name!r} is no member of a {model.__name__}. Its members are {known}."
    return BadField("Some fields are unknown.", places=[Place("query.fields", message)])
