"""Does the slow first work of a process before somebody waits for it, and keeps up with changes.

The first search of a kind loads its index and its models, and imports their code; the first search
with a file starts the process that reads it. After a start, one search of each kind does all this
in the background. From then on, changes of the library and new models are loaded as they come, so
that no search waits for them. A search catches up itself too: no answer depends on this.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from app.errors import StorageError
from app.kinedex_error import KinedexError
from app.services.find import find
from app.services.find.by_pose import find_pose
from app.services.find.queries import MotionQuery, PoseQuery, WordQuery
from app.services.find.query_source import QuerySource
from app.services.library.analysis_pool import AnalysisRequest
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.store import models

_log = logging.getLogger(__name__)

MAX_CLIPS = 20_000
"""Windows are loaded before somebody asks for them only in a library of at most this many clips,
because they need more memory than all other indexes."""
MAX_FILE_BYTES = 2**20
"""The largest file that is read for the first time: others take too long."""
WORD_MODES = ("default", "cca")
_UNREADABLE = b"\0"
"""The content of a file that no format has: to refuse it starts the process that reads files."""


class Warmth:
    """Whether the first work is done, and what is loaded. One thread calls its methods."""

    def __init__(self, lib: Library) -> None:
        self._lib = lib
        self._models: object = None
        self.is_warm = False

    def warm(self, is_stopping: Callable[[], bool]) -> None:
        """Do the first work of all kinds of searches. An empty library needs none.

        is_stopping: whether to leave out the rest.
        """
        self._models = self._current_models()
        for step in self._steps():
            if is_stopping():
                return
            try:
                step()
            except KinedexError as problem:
                # No models yet, a clip that was deleted meanwhile: then there is nothing to load.
                _log.debug("not warmed: %s", problem.detail)
        self.is_warm = True

    def follow(self) -> None:
        """Load what has changed since. Raises StorageError."""
        lib = self._lib
        others = (lib.paced, lib.segments, lib.poses, lib.word_windows, *lib.windows.values())
        for index in (lib.index, *others):
            if index.is_loaded:
                index.catch_up(lib.store)
        now = self._current_models()
        if now != self._models:
            self._models = now
            for step in self._of_models():
                try:
                    step()
                except StorageError:
                    raise
                except KinedexError as problem:
                    _log.debug("not loaded: %s", problem.detail)

    def _current_models(self) -> object:
        with self._lib.store.read() as tx:
            return models.current_ids(tx)

    def _steps(self) -> Iterator[Callable[[], object]]:
        lib = self._lib
        labels = lib.index.state[1].labels
        alive = np.flatnonzero(labels.alive)
        if not len(alive):
            return
        # The shortest clip: to find it costs nothing, and to compare it costs least.
        clip_id = str(labels.ids[alive[labels.durations[alive].argmin()]])
        clip = QuerySource(clip_id=clip_id)
        yield partial(lib.pool.read, AnalysisRequest(content=_UNREADABLE))
        yield partial(self._search_file, clip_id)
        yield partial(find.find_motion, lib, MotionQuery(clip))
        yield from self._of_models()
        yield partial(find_pose, lib, PoseQuery(clip, time=0.0))
        yield partial(find.find_motion, lib, MotionQuery(clip, scope="segments"))
        if len(alive) <= MAX_CLIPS:
            yield partial(find.find_motion, lib, MotionQuery(clip, scope="windows"))
            # A search reads only those that are as long as its query.
            for index in (*lib.windows.values(), lib.word_windows):
                yield partial(index.catch_up, lib.store)

    def _of_models(self) -> Iterator[Callable[[], object]]:
        for mode in WORD_MODES:
            yield partial(self._search_words, mode)
        yield partial(self._lib.models.recognizer, self._lib.store)

    def _search_file(self, clip_id: str) -> None:
        clip = ready_clip(self._lib, clip_id)
        if clip.file_size <= MAX_FILE_BYTES:
            with self._lib.store.files.open(clip.sha256) as content:
                find.find_motion(self._lib, MotionQuery(QuerySource(content=content)))

    def _search_words(self, mode: str) -> None:
        words = self._lib.models.words(self._lib.store).model.vocabulary.words
        find.find_words(self._lib, WordQuery(words[:1], mode))
