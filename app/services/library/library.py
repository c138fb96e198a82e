"""An open library: the settings, the store, the indexes and the models that services share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

from app.analysis.descriptors.windows import WIDTH, WINDOW_SCALES
from app.analysis.descriptors.word_windows import INPUT_WIDTH, WORD_WINDOW_SPANS, WORD_WINDOWS
from app.analysis.segments.segments import SEGMENT_SPANS, SEGMENT_VECTORS, SEGMENT_WIDTH
from app.config import Settings
from app.search.composed.body_parts import PoseSummaries
from app.search.duplicates.candidates import MOMENTS
from app.search.index.array_cache import ArrayCache
from app.search.index.model_rows import ModelRows
from app.search.index.projected_index import ProjectedIndex
from app.search.index.vector_index import PACED_VECTORS, VectorIndex
from app.search.pose.by_pose import POSES
from app.search.windows.part_scores import PartScores
from app.search.windows.parts import parts_layout
from app.services.library.analysis_pool import AnalysisPool, Limits
from app.services.library.fitted_models import METRICS, FittedModels, ModelKind
from app.services.library.kept_clips import KeptClips
from app.services.library.kept_tree import KeptTree
from app.store import identity
from app.store.database.access import ServerOptions
from app.store.folders import warn_if_open
from app.store.store import Store
from app.store.upkeep.health import Health

ARRAY_CACHE_BYTES = 128 * 2**20
"""Descriptors kept in memory for re-ranking; the least recently used go first."""


@dataclass(frozen=True, slots=True)
class Library:
    """The first argument of every service call. A process has one; threads may share it.

    health: whether the store can do its work; the API server starts it. index: the motion vectors
    of all clips; paced: the same at a common pace. arrays: descriptors in memory, for ranking
    again. word_scores, symbol_points, cca_points: the outputs of the word models for the indexed
    clips. pool: analyzes uploaded queries; a worker has its own pool. windows: the windows of all
    clips, by the name of their scale; segments: the segments of all clips; poses: the pose covers
    of all clips, and pose_summaries their means and spreads; word_windows: the windows in which
    words are looked for, and window_words: their probabilities; moments: their moments, for
    near-duplicates; the first search that needs paced or one of these five loads it. metrics: the
    clips' coordinates in each learned metric. tree: of the labels. kept_clips: the JSON of clips
    that searches showed.
    """

    settings: Settings
    store: Store
    health: Health
    index: VectorIndex
    paced: VectorIndex
    arrays: ArrayCache
    models: FittedModels
    word_scores: ModelRows
    symbol_points: ModelRows
    cca_points: ModelRows
    pool: AnalysisPool
    windows: Mapping[str, VectorIndex]
    segments: VectorIndex
    poses: VectorIndex
    pose_summaries: PoseSummaries
    word_windows: VectorIndex
    window_words: PartScores
    moments: VectorIndex
    metrics: Mapping[ModelKind, ProjectedIndex]
    tree: KeptTree
    kept_clips: KeptClips

    @classmethod
    def open(cls, settings: Settings, *, prepare: bool = True) -> Self:
        """Open the library that the settings name; create it if it does not exist.

        prepare: False never writes, so it does not create a library. Raises DatabaseOutOfDate, and
        LibraryMismatch if the files and the database belong to different libraries.
        """
        identify = identity.prepare if prepare else identity.check
        library_id = identify(settings.database, settings.files_place)
        warn_if_open(settings.data_dir)
        cache = ArrayCache(ARRAY_CACHE_BYTES)
        # A clip that changed has new arrays: the index notices it first, and the cache must follow.
        index = VectorIndex(on_change=cache.forget)
        options = ServerOptions(
            settings.database_connections, settings.database_statement_timeout_s
        )
        store = Store.open(settings.database, settings.files_place, library_id, options)
        return cls(
            settings=settings,
            store=store,
            health=Health(store),
            index=index,
            paced=VectorIndex(layout=PACED_VECTORS),
            arrays=cache,
            models=FittedModels(),
            word_scores=ModelRows(),
            symbol_points=ModelRows(),
            cca_points=ModelRows(),
            pool=AnalysisPool(query_limits(settings), cache=settings.cache_dir),
            windows={
                scale.name: VectorIndex(layout=parts_layout(scale.vectors, scale.spans, WIDTH))
                for scale in WINDOW_SCALES
            },
            segments=VectorIndex(
                layout=parts_layout(SEGMENT_VECTORS, SEGMENT_SPANS, SEGMENT_WIDTH)
            ),
            poses=VectorIndex(layout=POSES),
            pose_summaries=PoseSummaries(),
            word_windows=VectorIndex(
                layout=parts_layout(WORD_WINDOWS, WORD_WINDOW_SPANS, INPUT_WIDTH)
            ),
            window_words=PartScores(),
            moments=VectorIndex(layout=MOMENTS),
            metrics={kind: ProjectedIndex(index) for kind in METRICS},
            tree=KeptTree(),
            kept_clips=KeptClips(),
        )

    def close(self) -> None:
        """Stop the analysis processes and close the database connections."""
        self.pool.close()
        self.store.close()


def query_limits(settings: Settings) -> Limits:
    """The limits of the analysis of an uploaded query. A client waits for it, so it is short."""
    return Limits(
        settings.query_timeout_s,
        settings.analysis_memory_mb,
        settings.max_frames,
        settings.max_joints,
    )


def ingest_limits(settings: Settings) -> Limits:
    """The limits of the analysis of a clip. Nobody waits for it."""
    return Limits(
        settings.analysis_timeout_s,
        settings.analysis_memory_mb,
        settings.max_frames,
        settings.max_joints,
    )
