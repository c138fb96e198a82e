"""The asynchronous client has the same methods."""

from __future__ import annotations

import asyncio
from typing import TypeVar

import pytest

from app.demo import DemoClip
from kinedex import AsyncKinedex, KinedexError
from tests.live import NO_TLS, Live

Result = TypeVar("Result")


def _client(live: Live) -> AsyncKinedex:
    return AsyncKinedex(live.url, verify=NO_TLS, trust_env=False)


def test_lists_searches_and_uploads(demo_service: Live, take: DemoClip) -> None:
    async def use() -> None:
        async with _client(demo_service) as client:
            kicks = [clip async for clip in client.clips.list(task="kick", limit=3)]
            assert len(kicks) == 3
            assert await client.clips.list(task="nosuch").first() is None
            assert await client.clips.list(task="nosuch").total() == 0
            found = await asyncio.gather(
                client.search.motion(kicks[0].id, limit=1),
                client.search.motion(file=("query.bvh", take.content), limit=1),
                client.recognize(kicks[0].id),
            )
            assert len(found[1]) == 1
            sent: list[int] = []
            created = await client.clips.upload(
                ("take.bvh", take.content), progress=lambda done, _: sent.append(done)
            )
            assert sent[-1] == len(take.content)
            assert created.job is not None
            job = await client.jobs.wait(created.job.id, timeout=300)
            assert [one.state async for one in client.jobs.follow(job.id)] == ["succeeded"]
            await client.clips.delete(created.clip.id)
            with pytest.raises(KinedexError, match="no clip"):
                await client.clips.get(created.clip.id)

    asyncio.run(use())
