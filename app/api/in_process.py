"""The API inside the process of a command: the same routes, checks and problems, without a port.

The caller is the user of this machine, who can read the data directory anyway. So no key is needed.
There are no limits on time, no metrics and no protection against slow clients.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module

import httpx2
from anyio.from_thread import BlockingPortal, start_blocking_portal
from fastapi import FastAPI
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.failures.handlers import answer_unexpected, install_handlers
from app.api.guard.callers import Caller
from app.api.guard.gates import Gates
from app.api.guard.limits import BodyLimit
from app.config import DAY_S
from app.quick_imports import without_collector
from app.services.library.library import Library

MODULES = {
    "search_motion": "search",
    "search_words": "search",
    "search_pose": "poses",
    "recognize": "recognize",
    "synthesize": "synthesize",
    "list_clips": "clips",
    "get_clip": "clips",
    "update_clip": "clips",
    "delete_clip": "clips",
    "list_jobs": "jobs",
    "get_job": "jobs",
    "list_files": "jobs",
    "cancel_or_delete_job": "jobs",
    "list_models": "models",
    "request_fit": "models",
    "get_status": "status",
    "get_export": "export",
    "list_audit": "audit",
}
"""The module of routes of an operation. To import all modules takes a second; other operations
import them all."""


class _LocalUser:
    """ASGI middleware: the caller may do everything."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        caller = Caller(has_key=False, is_free=True)
        scope.setdefault("state", {})["caller"] = caller
        await self.app(scope, receive, send)


class InProcess(httpx2.BaseTransport):
    """A transport of httpx2 that calls the API of a library in this process."""

    def __init__(self, library: Library, portal: BlockingPortal) -> None:
        self._library = library
        self._portal = portal
        self._transports: dict[str, httpx2.ASGITransport] = {}

    def handle_request(self, request: httpx2.Request) -> httpx2.Response:
        """Answer a request whose extension `operation` names the operation."""
        module = MODULES.get(request.extensions.get("operation", ""), "")
        if module not in self._transports:
            transport = httpx2.ASGITransport(app=_application(self._library, module))
            self._transports[module] = transport
        try:
            return self._portal.call(_answer, self._transports[module], request)
        except Exception as error:  # noqa: BLE001 - as the service does: a problem and a log entry
            answer = answer_unexpected(error)
            return httpx2.Response(answer.status_code, content=bytes(answer.body))


@contextmanager
def in_process(library: Library) -> Iterator[InProcess]:
    """A transport to the API of an open library; the library stays open."""
    with start_blocking_portal() as portal:
        yield InProcess(library, portal)


def _application(library: Library, module: str) -> FastAPI:
    """The application with the routes of one module, or with all routes if `module` is empty."""
    app = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)
    app.state.library = library
    app.state.settings = library.settings
    app.state.stopping = False
    app.state.loading = None
    app.state.gates = Gates.of(DAY_S)
    install_handlers(app)
    with without_collector():
        if module:
            app.include_router(import_module(f"app.api.routes.{module}").router)
        else:
            for one in import_module("app.api.app").ROUTES:
                app.include_router(one.router)
    app.add_middleware(BodyLimit, settings=library.settings)
    app.add_middleware(_LocalUser)
    return app


async def _answer(transport: httpx2.ASGITransport, request: httpx2.Request) -> httpx2.Response:
    """The complete answer, which no longer depends on the event loop."""
    response = await transport.handle_async_request(request)
    content = await response.aread()
    return httpx2.Response(response.status_code, headers=response.headers, content=content)
