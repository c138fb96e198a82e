"""Asyncio clients that ask a service many things at once, and remember how long it took."""

from __future__ import annotations

import asyncio
import itertools
import json
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import httpx2
import numpy as np

from app.demo import DemoClip
from tests.live import NET_S, NO_TLS

PERCENTILES = (50, 95, 99)
ANSWERED, REFUSED = (200, 202), (429, 503)


@dataclass(frozen=True)
class Request:
    """A search, by its path below `/v1/search` and its body; or the upload of a clip."""

    kind: str
    path: str = ""
    body: dict[str, Any] | None = None
    clip: DemoClip | None = None


@dataclass
class Outcome:
    """What became of requests.

    seconds: of the answered ones, by kind; statuses: of all; refusals: seconds of those that were
    answered 429 or 503; without_hint: refusals without Retry-After; stored: ids of acknowledged
    clips; broken: connections that ended without an answer.
    """

    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    statuses: Counter[int] = field(default_factory=Counter)
    refusals: list[float] = field(default_factory=list)
    without_hint: int = 0
    stored: list[str] = field(default_factory=list)
    broken: int = 0

    def row(self, kind: str) -> str:
        """Percentiles in milliseconds."""
        found = (
            np.percentile(self.seconds[kind], PERCENTILES) if self.seconds[kind] else [np.nan] * 3
        )
        return "".join(f"{1e3 * seconds:9.1f}" for seconds in found)

    def percentile(self, kind: str, percent: float) -> float:
        """Seconds."""
        return float(np.percentile(self.seconds[kind], percent))


def drive(url: str, requests: Iterator[Request], clients: int, seconds: float) -> Outcome:
    """Let `clients` ask at the same time, each one request after another, for `seconds`."""
    return asyncio.run(_drive(url, requests, clients, seconds))


async def _drive(url: str, requests: Iterator[Request], clients: int, seconds: float) -> Outcome:
    outcome, ends = Outcome(), time.perf_counter() + seconds
    limits = httpx2.Limits(max_connections=clients)
    async with httpx2.AsyncClient(
        base_url=url, timeout=NET_S, trust_env=False, verify=NO_TLS, limits=limits
    ) as client:

        async def one() -> None:
            while time.perf_counter() < ends:
                await _ask(client, next(requests), outcome)

        await asyncio.gather(*(one() for _ in range(clients)))
    return outcome


_numbers = itertools.count()


async def _ask(client: httpx2.AsyncClient, request: Request, outcome: Outcome) -> None:
    began = time.perf_counter()
    try:
        if request.clip is not None:
            content = request.clip.content + b"\n" * (1 + next(_numbers))  # other bytes each time
            answer = await client.post("/v1/clips", files={"file": (request.clip.path, content)})
        else:
            answer = await client.post(f"/v1/search/{request.path}", json=request.body)
    except httpx2.TransportError:
        outcome.broken += 1
        return
    took = time.perf_counter() - began
    outcome.statuses[answer.status_code] += 1
    if answer.status_code in ANSWERED:
        outcome.seconds[request.kind].append(took)
        if request.clip is not None:
            outcome.stored.append(answer.json()["clip"]["id"])
    elif answer.status_code in REFUSED:
        outcome.refusals.append(took)
        outcome.without_hint += "retry-after" not in answer.headers


def flood(url: str, requests: Iterator[Request], clients: int, seconds: float) -> Outcome:
    """As `drive`, for more searches than a service can answer; refused clients wait as they are
    told.

    httpx2 takes 4 ms of CPU time for a call. With some hundred clients, one would measure how long
    answers wait for the driver. So these clients write bytes, and read as little as they can.
    """
    return asyncio.run(_flood(url, requests, clients, seconds))


async def _flood(url: str, requests: Iterator[Request], clients: int, seconds: float) -> Outcome:
    outcome, ends = Outcome(), time.perf_counter() + seconds
    address = ("127.0.0.1", int(url.rpartition(":")[2]))

    async def one() -> None:
        reader, writer = await asyncio.open_connection(*address)
        while time.perf_counter() < ends:
            request = next(requests)
            body = json.dumps(request.body).encode()
            head = (
                f"POST /v1/search/{request.path} HTTP/1.1\r\nHost: 127.0.0.1\r\n"
                f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
            )
            began = time.perf_counter()
            writer.write(head.encode() + body)
            try:
                status, headers = await _answer(reader)
            except (asyncio.IncompleteReadError, OSError):
                outcome.broken += 1
                return
            took = time.perf_counter() - began
            outcome.statuses[status] += 1
            if status in REFUSED:
                outcome.refusals.append(took)
                outcome.without_hint += b"retry-after" not in headers
                await asyncio.sleep(float(headers.get(b"retry-after", b"0")))
            else:
                outcome.seconds[request.kind].append(took)
        writer.close()

    await asyncio.gather(*(one() for _ in range(clients)))
    return outcome


async def _answer(reader: asyncio.StreamReader) -> tuple[int, dict[bytes, bytes]]:
    """The status and the headers of an answer, whose body is read and dropped."""
    first, *lines = (await reader.readuntil(b"\r\n\r\n")).strip().split(b"\r\n")
    pairs = (line.split(b":", 1) for line in lines)
    headers = {name.strip().lower(): value.strip() for name, value in pairs}
    await reader.readexactly(int(headers.get(b"content-length", b"0")))
    return int(first.split()[1]), headers
