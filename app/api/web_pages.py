"""The pages: what `make install` builds from `app/web` into `app/web/dist`.

Every address of a page is answered with the one `index.html`, whose script shows what the
address names. All other files have a hash of their content in their names, so that browsers keep
them for good.
"""

from __future__ import annotations

import hashlib
import mimetypes
from pathlib import Path

from fastapi import FastAPI, Request, Response
from fastapi.responses import HTMLResponse
from fastapi.staticfiles import StaticFiles
from starlette.types import Scope

from app.api.guard.admission import at_once
from app.api.guard.page_paths import DOCS, PAGE_NAMES

DIST = Path(__file__).resolve().parents[1] / "web" / "dist"
ASSETS = "/assets"
ENCODINGS = {"br": ".br", "gzip": ".gz"}
"""Compressed at build time, the smallest first: the ending of each file's other form."""
FOR_GOOD = "public, max-age=31536000, immutable"
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "media-src 'self' blob:; connect-src 'self'; worker-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
NOT_BUILT = f"""\
<!doctype html><html lang="en"><title>Kinedex</title><h1>The pages are not built</h1>
<p>Run <code>make install</code> and start Kinedex again. The API works without them:
<a href="{{root}}{DOCS}">{DOCS}</a> describes it.</p></html>
"""


class Assets(StaticFiles):
    """Files of hashed names, compressed where the client takes that."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file at a path. Raises HTTPException 404, 405."""
        taken = Request(scope).headers.get("accept-encoding", "")
        kinds = {part.partition(";")[0].strip() for part in taken.split(",")}
        for encoding, ending in ENCODINGS.items():
            if encoding in kinds and self.lookup_path(path + ending)[1] is not None:
                response = await super().get_response(path + ending, scope)
                response.headers["Content-Encoding"] = encoding
                kind = mimetypes.guess_type(path)[0] or "application/octet-stream"
                response.headers["Content-Type"] = kind
                break
        else:
            response = await super().get_response(path, scope)
        response.headers["Vary"] = "Accept-Encoding"
        response.headers["Cache-Control"] = FOR_GOOD
        return response


def install_pages(app: FastAPI, dist: Path = DIST) -> None:
    """Serve the built pages of a folder; where they are not built, `/` says what to do."""

    async def page(request: Request) -> Response:
        root = str(request.scope.get("root_path", "")).rstrip("/")
        return _index(dist, root, request.headers.get("if-none-match", ""))

    for path in ("/", *(f"/{name}{rest}" for name in PAGE_NAMES for rest in ("", "/{rest:path}"))):
        app.add_api_route(
            path, page, methods=["GET", "HEAD"], include_in_schema=False, dependencies=[at_once]
        )
    assets = dist / ASSETS.strip("/")
    if assets.is_dir():
        app.mount(ASSETS, Assets(directory=assets), name="assets")


def _index(dist: Path, root: str, known: str) -> Response:
    try:
        template = (dist / "index.html").read_text(encoding="utf-8")
    except FileNotFoundError:
        return HTMLResponse(NOT_BUILT.format(root=root), 404, {"Cache-Control": "no-store"})
    text = template.replace('"./', f'"{root}/')
    tag = f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache", "Content-Security-Policy": POLICY}
    if tag in known:
        return Response(None, 304, headers)
    return HTMLResponse(text, headers=headers)
