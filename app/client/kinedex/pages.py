"""Lists that are fetched page by page while the program iterates over them."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from kinedex.call import Call
from kinedex.records import Page, as_json

if TYPE_CHECKING:
    import pandas as pd

Item = TypeVar("Item")
MAX_PAGE = 1000
"""Items in one answer."""


class _Plan(Generic[Item]):
    """The calls that fetch a list, one after the other."""

    def __init__(self, call: Call[Page[Item]]) -> None:
        limit = call.query.get("limit")
        self.left: int | None = limit
        self.call: Call[Page[Item]] | None = call if limit is None or limit > 0 else None
        self._fetch_from(call.query.get("cursor"))

    def take(self, page: Page[Item]) -> list[Item]:
        """The items of a page that are within the limit; prepares the next call."""
        items = page.items if self.left is None else page.items[: self.left]
        if self.left is not None:
            self.left -= len(items)
        if page.next is None or self.left == 0:
            self.call = None
        else:
            self._fetch_from(page.next)
        return items

    def _fetch_from(self, cursor: str | None) -> None:
        if self.call is not None:
            size = MAX_PAGE if self.left is None else min(self.left, MAX_PAGE)
            query = {**self.call.query, "limit": size}
            self.call = replace(
                self.call, query=query if cursor is None else query | {"cursor": cursor}
            )


def _total(page: Any) -> int:
    return int(page.total)


class Pages(Generic[Item]):
    """A list of the service. Each iteration fetches it again, page by page."""

    def __init__(
        self, call: Call[Page[Item]], send: Callable[[Call[Page[Item]]], Page[Item]]
    ) -> None:
        self._call = call
        self._send = send

    def pages(self) -> Iterator[list[Item]]:
        """The items of each page."""
        plan = _Plan(self._call)
        while plan.call is not None:
            yield plan.take(self._send(plan.call))

    def __iter__(self) -> Iterator[Item]:
        for page in self.pages():
            yield from page

    def first(self) -> Item | None:
        """The first item, or None if the list is empty."""
        call = replace(self._call, query={**self._call.query, "limit": 1})
        return next(iter(self._send(call).items), None)

    def total(self) -> int:
        """The number of items on all pages, whatever the limit; above 100,000 an estimate."""
        return _total(self._send(replace(self._call, query={**self._call.query, "limit": 1})))

    def to_dataframe(self) -> pd.DataFrame:
        """A table with one row for each item of all pages (needs pandas)."""
        from kinedex.tables import dataframe

        return dataframe(as_json(list(self)))


class AsyncPages(Generic[Item]):
    """A list of the service, for `async for`. Each iteration fetches it again, page by page."""

    def __init__(
        self, call: Call[Page[Item]], send: Callable[[Call[Page[Item]]], Awaitable[Page[Item]]]
    ) -> None:
        self._call = call
        self._send = send

    async def pages(self) -> AsyncIterator[list[Item]]:
        """The items of each page."""
        plan = _Plan(self._call)
        while plan.call is not None:
            yield plan.take(await self._send(plan.call))

    async def __aiter__(self) -> AsyncIterator[Item]:
        async for page in self.pages():
            for item in page:
                yield item

    async def first(self) -> Item | None:
        """The first item, or None if the list is empty."""
        call = replace(self._call, query={**self._call.query, "limit": 1})
        return next(iter((await self._send(call)).items), None)

    async def total(self) -> int:
        """The number of items on all pages, whatever the limit; above 100,000 an estimate."""
        call = replace(self._call, query={**self._call.query, "limit": 1})
        return _total(await self._send(call))

    async def to_dataframe(self) -> pd.DataFrame:
        """A table with one row for each item of all pages (needs pandas)."""
        from kinedex.tables import dataframe

        return dataframe(as_json([item async for item in self]))
