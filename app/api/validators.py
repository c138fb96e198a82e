"""ETag and If-None-Match: a client that has the current answer gets 304 without a body.

A tag is a digest of what the answer is made from, not of the answer. So an unchanged answer is
never computed. The tags are weak, because the same answer may be sent compressed or not. All
answers with a tag may be kept by the client, but it must ask before it uses them again.
"""

from __future__ import annotations

import hashlib

from fastapi import Depends, FastAPI, Request, Response

from app import __version__
from app.analysis.analyze import ANALYSIS_VERSION
from app.api.deps import Lib
from app.api.guard.admission import OwnThreads
from app.api.openapi import ClipId
from app.api.streams import prefers_octets
from app.services.clips import catalogue

TAG_LENGTH = 32
"""Hexadecimal digits of a tag."""
KEEP_BUT_ASK = "private, no-cache"
"""Cache-Control of answers with a tag."""
UNCHANGED = {"description": "The answer with the tag in If-None-Match is still current."}
"""The answer 304 in the description of a route."""
NOT_OF_ONE_CLIP = "dimensions"
"""With this query parameter, an answer depends on other clips."""
_threads = OwnThreads(4)


class Unchanged(Exception):
    """The client has the current answer already."""

    def __init__(self, tag: str) -> None:
        self.tag = tag


def install_validators(app: FastAPI) -> None:
    """Answer 304 to clients whose answer is still current."""

    async def answer(_request: Request, unchanged: Exception) -> Response:
        tag = unchanged.tag if isinstance(unchanged, Unchanged) else ""
        return Response(status_code=304, headers={"ETag": tag, "Cache-Control": KEEP_BUT_ASK})

    app.add_exception_handler(Unchanged, answer)


def weak_tag(*sources: object) -> str:
    """Return the tag of an answer that is made from `sources`, by this version of Kinedex."""
    content = repr((__version__, ANALYSIS_VERSION, *sources)).encode("utf-8", "surrogatepass")
    return f'W/"{hashlib.sha256(content).hexdigest()[:TAG_LENGTH]}"'


def validate(request: Request, tag: str) -> None:
    """Give the answer of this request a tag. Raises Unchanged if the client sent the same tag."""
    known = [part.strip() for part in request.headers.get("if-none-match", "").split(",")]
    if tag.removeprefix("W/") in {one.removeprefix("W/") for one in known}:
        raise Unchanged(tag)
    request.state.answer_headers = {"ETag": tag, "Cache-Control": KEEP_BUT_ASK}


async def _validate_clip_view(request: Request, lib: Lib, clip_id: ClipId) -> None:
    """A dependency of routes that show one ready clip: it validates the client's answer.

    The tag depends on the version of the clip, which grows with every change of the clip, and on
    the request. Raises Unchanged.
    """
    if NOT_OF_ONE_CLIP in request.query_params:
        return
    version = await _threads.run(lambda: catalogue.shown_version(lib, clip_id))
    if version is not None:
        path, query = request.url.path, request.url.query
        validate(request, weak_tag(clip_id, version, path, query, prefers_octets(request)))


of_one_clip = Depends(_validate_clip_view)
