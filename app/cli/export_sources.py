"""Where `kinedex export` gets clips from: the library of this machine, or a service at --url.

The library is read without the API, which would keep a whole file in memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol
from urllib.parse import unquote

import typer

from app.cli.options import filter_of
from app.cli.session import open_client
from app.cli.settings import open_library, remote_of
from app.services.views.exported import ClipExport, Export, FileNames

if TYPE_CHECKING:
    import httpx2

    from app.services.library.library import Library
    from kinedex import Kinedex
    from kinedex.call import Call

LEFT_OUT = frozenset({"clip_not_found", "clip_not_ready", "no_gait", "not_enough_keyposes"})
"""The codes of problems that concern one clip, and not the others."""
_ENCODED_NAME = "filename*=UTF-8''"


class Source(Protocol):
    """Gives clips as files. options: those of `app.services.views.export.export`, with `format`."""

    def ready_ids(self, filter_json: str) -> Sequence[str]:
        """The ids of the ready clips that pass a filter. Raises BadField."""

    def one(self, clip_id: str, options: dict[str, Any]) -> Export:
        """The file of a clip. Raises KinedexError of the library, or that of the client."""

    def each(self, clip_ids: Sequence[str], options: dict[str, Any]) -> Iterator[ClipExport]:
        """The clips one after the other; no two files have the same name."""


@contextmanager
def open_source(context: typer.Context) -> Iterator[Source]:
    """The source that the options of the command choose, closed at the end."""
    if remote_of(context) is not None:
        with open_client(context) as client:
            yield _Service(client)
        return
    with open_library(context) as lib:
        yield _Local(lib)


@dataclass(frozen=True, slots=True)
class _Local:
    lib: Library

    def ready_ids(self, filter_json: str) -> Sequence[str]:
        from app.search.index.filters import parse_filter
        from app.services.views.export_many import ready_ids

        return ready_ids(self.lib, parse_filter(filter_of(filter_json)))

    def one(self, clip_id: str, options: dict[str, Any]) -> Export:
        from app.services.views.export import export

        return export(self.lib, clip_id, **options)

    def each(self, clip_ids: Sequence[str], options: dict[str, Any]) -> Iterator[ClipExport]:
        from app.services.views.export_many import export_each

        return export_each(self.lib, clip_ids, **options)


@dataclass(frozen=True, slots=True)
class _Service:
    client: Kinedex

    def ready_ids(self, filter_json: str) -> Sequence[str]:
        clips = self.client.clips.list(state="ready", filter=filter_of(filter_json), fields=["id"])
        return [clip.id for clip in clips]

    def one(self, clip_id: str, options: dict[str, Any]) -> Export:
        from kinedex.calls.export import get_export

        call: Call[Any] = get_export(clip_id, options["format"].value, **_query(options))
        file: Export = self.client.send(replace(call, read=_read))
        return file

    def each(self, clip_ids: Sequence[str], options: dict[str, Any]) -> Iterator[ClipExport]:
        from kinedex import KinedexError

        names = FileNames()
        for clip_id in dict.fromkeys(clip_ids):
            try:
                file = self.one(clip_id, options)
            except KinedexError as problem:
                if problem.code not in LEFT_OUT:
                    raise
                yield ClipExport(clip_id, None, problem.detail)
                continue
            yield ClipExport(clip_id, replace(file, file_name=names.free(file.file_name, clip_id)))


def _query(options: dict[str, Any]) -> dict[str, Any]:
    """The parameters of the call, by name, without those that were not given."""
    reduction = options["reduction"]
    others = {name: one for name, one in options.items() if name not in ("format", "reduction")}
    query = {
        name: getattr(value, "value", value) for name, value in others.items() if value is not None
    }
    if reduction is not None:
        query |= {"dimensions": reduction.dimensions, "basis": reduction.basis.value}
    return query


def _read(response: httpx2.Response) -> Export:
    """An export with the name that the service gives it, without folders."""
    header = response.headers.get("Content-Disposition", "")
    name = unquote(header.rpartition(_ENCODED_NAME)[2])
    return Export(name.replace("\\", "/").rpartition("/")[2] or "clip", [response.content])
