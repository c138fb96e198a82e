"""Calls: labels. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.call import Call, nothing, path_of, record
from kinedex.sent import given
from kinedex.types.labels import NamedCounts


def list_persons(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Persons, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    return Call(
        "list_persons",
        "GET",
        "/v1/persons",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def forget_person(name: str) -> Call[None]:
    """Remove a person's label from all clips, and delete every model that holds the person.

    The models are fitted again in the background. Until then recognition, synthesis and
    `metric-person` answer 409 `model_not_fitted` with `Retry-After`. The clips and the names of
    their files stay.
    """
    return Call("forget_person", "DELETE", path_of("/v1/persons/{name}", name=name), nothing)


def list_tasks(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Tasks, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    return Call(
        "list_tasks",
        "GET",
        "/v1/tasks",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def list_words(
    *, q: str | None = None, limit: int | None = None, cursor: str | None = None
) -> Call[NamedCounts]:
    """Words by name, with numbers of clips; or completions of `q`, the likeliest first.

    q: Only words that begin with this or hold it, or else words of which it is a form.
    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    return Call(
        "list_words",
        "GET",
        "/v1/words",
        record(NamedCounts),
        query=given(q=q, limit=limit, cursor=cursor),
    )
