"""The application: routes, middlewares and the library that they share."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version

import anyio
from fastapi import FastAPI
from fastapi.concurrency import run_in_threadpool
from fastapi_offline import FastAPIOffline

from app.api.description import describe
from app.api.docs import STATIC, install_docs
from app.api.examples import example_values
from app.api.failures.handlers import install_handlers
from app.api.guard.access_check import AccessCheck
from app.api.guard.compression import Compression
from app.api.guard.cors import Cors
from app.api.guard.envelope import Envelope
from app.api.guard.gates import Gates
from app.api.guard.idempotency import Idempotency
from app.api.guard.limits import BodyLimit
from app.api.guard.methods import KnownMethods
from app.api.guard.rates import RateLimits
from app.api.guard.shedding import Shedding
from app.api.guard.slow_bodies import SlowBodies
from app.api.loading import Loading
from app.api.metrics import install_metrics
from app.api.routes import (
    alignment,
    audit,
    clip_annotations,
    clip_views,
    clips,
    collections,
    composed_search,
    curation,
    edits,
    evaluations,
    export,
    health,
    imports,
    jobs,
    keyposes,
    label_tree,
    labels,
    low_dimensional,
    manifests,
    measures,
    models,
    poses,
    recognize,
    recordings,
    search,
    searches,
    segments,
    session,
    space,
    status,
    studies,
    suggestions,
    symbols,
    synthesize,
    webhooks,
)
from app.api.schemas.composed_search import ComposedSearch
from app.api.schemas.pose import PoseSearch
from app.api.schemas.recognition import Recognize
from app.api.schemas.search import MotionSearch
from app.api.schemas.synthesis import Synthesize
from app.api.schemas.why import WhySearch
from app.api.validators import install_validators
from app.api.web_pages import install_pages
from app.config import Settings
from app.kinedex_error import KinedexError
from app.services.library.library import Library
from app.store.sessions import Sessions
from app.store.shared_rows import open_engine

_SUMMARY = "Search human motion by example and by words, and ask who does what."
_DESCRIPTION = """\
Store a clip with `POST /v1/clips`, follow its job until the clip is `ready`, then search with
its id. The examples name clips, jobs, persons and other objects of this library, so that you can
run them unchanged. If you read `CLIP_ID`, `PERSON` or another word in capitals, there is no such
object yet, or calls need a key.

Times are ISO 8601 in UTC, durations seconds. Every failure is a problem (RFC 9457,
`application/problem+json`). Send an API key as `Authorization: Bearer KEY` or `X-API-Key: KEY`.

- **Long lists** are `{"items": [...], "next": cursor, "total": ...}`. `total` is the number of all
  items. It is exact up to 100,000 items, then an estimate (`total_is_exact`: false).
  `fields=id,name` chooses the members of each clip, and `fields=score,clip.id` those of each hit: a
  page of 1,000 hits then takes a third of the time.
- **Polling and pictures.** Clips, motions, pictures, exports and files have an `ETag`. Send it as
  `If-None-Match`: while nothing has changed, the answer is 304, without any computation. Answers
  are compressed by zstd or gzip.
- **Repeating a call.** Send a random `Idempotency-Key` with each POST that changes something. If
  you get no answer, send the call again with the same key: it takes effect once, also if Kinedex
  was killed in between. The answer 409 `answer_lost` says that it took effect, but its answer is
  lost.
- **Waiting.** Follow a job with `GET /v1/jobs/{id}/events`, or let Kinedex call you when it has
  ended: `POST /v1/webhooks`.
- **Long calls** (searches, recognition, synthesis, exports) end as 503 `deadline_exceeded` after a
  time limit, and get 503 `too_busy` if too many others wait. Both answers have `Retry-After`.
"""
ROUTES = (
    clips,
    recordings,
    edits,
    clip_views,
    alignment,
    keyposes,
    clip_annotations,
    low_dimensional,
    export,
    imports,
    jobs,
    search,
    composed_search,
    searches,
    collections,
    poses,
    recognize,
    synthesize,
    models,
    evaluations,
    labels,
    manifests,
    label_tree,
    measures,
    curation,
    symbols,
    suggestions,
    space,
    studies,
    segments,
    webhooks,
    audit,
    status,
    session,
    health,
)


def create_app(settings: Settings) -> FastAPI:
    """The HTTP service for the library that the settings name; opened when the server starts."""
    app: FastAPI = FastAPIOffline(
        docs_url=None,
        redoc_url=None,
        static_url=STATIC,
        title="Kinedex",
        version=version("kinedex"),
        summary=_SUMMARY,
        description=_DESCRIPTION,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
        lifespan=_lifespan,
        generate_unique_id_function=lambda route: route.name,
    )
    app.state.settings = settings
    app.state.library = None
    app.state.limits = None
    app.state.sessions = None
    app.state.loading = None
    app.state.stopping = False
    app.state.start_failure = None
    app.state.gates = Gates.of(settings.request_timeout_s, settings.processes)
    install_handlers(app)
    install_validators(app)
    for module in ROUTES:
        app.include_router(module.router)
    install_docs(app)
    install_pages(app)
    describe(
        app,
        [ComposedSearch, MotionSearch, PoseSearch, Recognize, Synthesize, WhySearch],
        lambda: example_values(app.state.library),
    )
    # The last one added is the outermost.
    app.add_middleware(Idempotency)
    app.add_middleware(BodyLimit, settings=settings)
    app.add_middleware(SlowBodies, settings=settings)
    app.add_middleware(AccessCheck)
    app.add_middleware(Shedding)
    if settings.cors_origins:
        app.add_middleware(Cors, origins=settings.cors_origins)
    install_metrics(app)
    app.add_middleware(KnownMethods)
    app.add_middleware(Compression)
    app.add_middleware(Envelope)
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    anyio.to_thread.current_default_thread_limiter().total_tokens = app.state.gates.threads
    try:
        library = await run_in_threadpool(Library.open, app.state.settings)
    except KinedexError as failure:
        app.state.start_failure = failure
        raise
    app.state.loading = loading = Loading(library)
    loading.start()
    library.health.start()
    app.state.limits = limits = RateLimits(library)
    rows = open_engine(library.store.database.engine, library.settings.data_dir)
    app.state.sessions = sessions = Sessions(rows)
    app.state.library = library
    try:
        yield
    finally:
        app.state.library = None
        await run_in_threadpool(loading.stop)
        await run_in_threadpool(library.health.stop)
        limits.close()
        sessions.close()
        await run_in_threadpool(library.close)
