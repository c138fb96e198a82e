"""The two clients: `Kinedex` waits for each answer, `AsyncKinedex` is for `async` programs."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import AsyncIterator, Iterator
from typing import Any, ClassVar, Self, TypeVar

import httpx2

from kinedex import groups, http
from kinedex.call import Call
from kinedex.errors import failure_of
from kinedex.methods import AsyncSender, Sender
from kinedex.waiting import AsyncJobs, Jobs

Answer = TypeVar("Answer")
DEFAULT_URL = "http://127.0.0.1:8000"
URL_ENV, KEY_ENV = "KINEDEX_URL", "KINEDEX_API_KEY"


def _address(url: str | None) -> str:
    return url or os.environ.get(URL_ENV) or DEFAULT_URL


def _key(api_key: str | None) -> str | None:
    return api_key or os.environ.get(KEY_ENV) or None


class Kinedex(groups.RootBase[Sender]):
    """A client of a Kinedex service.

    url: the address of the service; default: KINEDEX_URL, else http://127.0.0.1:8000. api_key:
    default: KINEDEX_API_KEY. options: further arguments of `httpx2.Client`, for example `timeout`,
    `verify`, `proxy` or `transport`.

    Every method raises KinedexError if the call fails. A call that the service is too busy for is
    sent again up to 3 times, after the time that the service names.
    """

    is_blocking: ClassVar[bool] = True

    def __init__(self, url: str | None = None, api_key: str | None = None, **options: Any) -> None:
        super().__init__(self)
        self.url = _address(url)
        with http.transport_failures(self.url):
            self._http = httpx2.Client(**http.options(self.url, _key(api_key), options))
        self.jobs = Jobs(self)

    def send(self, call: Call[Answer]) -> Answer:
        """Send a call and return its answer. Raises KinedexError."""
        attempt = 0
        while True:
            with http.transport_failures(self.url), http.request_of(self._http, call) as request:
                response = self._http.send(request)
            pause = http.pause_before_retry(response, call, attempt)
            if pause is None:
                answer: Answer = http.answer_of(response, call)
                return answer
            time.sleep(pause)
            attempt += 1

    def lines(self, path: str) -> Iterator[str]:
        """The lines of an answer while they arrive. Raises KinedexError."""
        with http.transport_failures(self.url), self._http.stream("GET", path) as response:
            if not response.is_success:
                raise failure_of(response.status_code, response.read())
            yield from response.iter_lines()

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class AsyncKinedex(groups.RootBase[AsyncSender]):
    """A client of a Kinedex service for `async` programs; the arguments are those of `Kinedex`.

    The methods are those of `Kinedex`, to be awaited. Lists are for `async for`.
    """

    is_blocking: ClassVar[bool] = False

    def __init__(self, url: str | None = None, api_key: str | None = None, **options: Any) -> None:
        super().__init__(self)
        self.url = _address(url)
        with http.transport_failures(self.url):
            self._http = httpx2.AsyncClient(**http.options(self.url, _key(api_key), options))
        self.jobs = AsyncJobs(self)

    async def send(self, call: Call[Answer]) -> Answer:
        """Send a call and return its answer. Raises KinedexError."""
        attempt = 0
        while True:
            with http.transport_failures(self.url), http.request_of(self._http, call) as request:
                response = await self._http.send(request)
            pause = http.pause_before_retry(response, call, attempt)
            if pause is None:
                answer: Answer = http.answer_of(response, call)
                return answer
            await asyncio.sleep(pause)
            attempt += 1

    async def lines(self, path: str) -> AsyncIterator[str]:
        """The lines of an answer while they arrive. Raises KinedexError."""
        with http.transport_failures(self.url):
            async with self._http.stream("GET", path) as response:
                if not response.is_success:
                    raise failure_of(response.status_code, await response.aread())
                async for line in response.aiter_lines():
                    yield line

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
