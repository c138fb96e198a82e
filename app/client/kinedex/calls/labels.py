"""Calls: labels. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, nothing, path_of, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.labels import FolderList, MetadataKeys, NamedCounts


def list_persons(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Persons, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_persons",
        "GET",
        "/v1/persons",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def forget_person(name: str) -> Call[None]:
    """Remove a person from all labels, and delete every model that holds the person.

    The person's name also leaves the names, paths, sources, words and metadata of clips, and the
    lists of imported files: `anna_walk.bvh` becomes `anonymous_walk.bvh`. In clips of others, a
    name without a letter leaves only metadata that are nothing but the name. The contents of the
    stored files stay. The models are fitted again in the background. Until then recognition,
    synthesis and `metric-person` answer 409 `model_not_fitted` with `Retry-After`.
    """
    return Call("forget_person", "DELETE", path_of("/v1/persons/{name}", name=name), nothing)


def list_tasks(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Tasks, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

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
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_words",
        "GET",
        "/v1/words",
        record(NamedCounts),
        query=given(q=q, limit=limit, cursor=cursor),
    )


def list_sources(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Sources of clips, with the number of clips from each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_sources",
        "GET",
        "/v1/sources",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def list_licenses(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Licenses, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_licenses",
        "GET",
        "/v1/licenses",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def list_metadata(*, limit: int | None = None, cursor: str | None = None) -> Call[MetadataKeys]:
    """The keys of the metadata of clips, with the kinds and the most frequent values of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import MetadataKeys

    return Call(
        "list_metadata",
        "GET",
        "/v1/metadata",
        record(MetadataKeys),
        query=given(limit=limit, cursor=cursor),
    )


def list_folders(
    *, limit: int | None = None, cursor: str | None = None, folder: str | None = None
) -> Call[FolderList]:
    """The folders directly in a folder, with the number of clips in and below each.

    A clip that was imported from a folder or a ZIP has the path that its file had there.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    folder: Default: the root.
    """
    from kinedex.types.labels import FolderList

    return Call(
        "list_folders",
        "GET",
        "/v1/folders",
        record(FolderList),
        query=given(limit=limit, cursor=cursor, folder=folder),
    )
