"""A library in use: its settings, store, index and what else the services share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

from app.analysis.descriptors.windows import WIDTH, WINDOW_SCALES
from app.analysis.segments.segments import SEGMENT_SPANS, SEGMENT_VECTORS, SEGMENT_WIDTH
from app.config import Settings
from app.search.index.array_cache import ArrayCache
from app.search.index.model_rows import ModelRows
from app.search.index.projected_index import ProjectedIndex
from app.search.index.vector_index import VectorIndex
from app.search.pose.by_pose import POSES
from app.search.windows.parts import parts_layout
from app.services.library.analysis_pool import AnalysisPool, Limits
from app.services.library.fitted_models import METRICS, FittedModels, ModelKind
from app.store import identity
from app.store.folders import warn_if_open
from app.store.store import Store
from app.store.upkeep.health import Health

ARRAY_CACHE_BYTES = 128 * 2**20
"""Descriptors kept in memory for re-ranking; the least recently used go first."""


@dataclass(frozen=True, slots=True)
class Library:
    """What every service call gets; one for each process, safe to share between threads.

    health: whether the store can do its work; whoever serves starts it.
    word_scores, symbol_points: what the word models make of the clips in the index.
    pool analyses uploaded queries; a worker has a pool of its own. segments: what lies between
    the keyposes of all clips, loaded by the first search that asks. windows: the windows of all
    clips by the name of their scale, and poses: the pose covers of all clips, both loaded by
    the first search that asks for them.
    """

    settings: Settings
    store: Store
    health: Health
    index: VectorIndex
    arrays: ArrayCache
    models: FittedModels
    word_scores: ModelRows
    symbol_points: ModelRows
    pool: AnalysisPool
    windows: Mapping[str, VectorIndex]
    segments: VectorIndex
    poses: VectorIndex
    metrics: Mapping[ModelKind, ProjectedIndex]

    @classmethod
    def open(cls, settings: Settings, *, prepare: bool = True) -> Self:
        """Open the library that the settings name, making it where there is none.

        Raises DatabaseOutOfDate; LibraryMismatch where its files are not those of its database.
        `prepare=False` never writes.
        """
        look = identity.prepare if prepare else identity.check
        library_id = look(settings.database, settings.files_dir)
        warn_if_open(settings.data_dir)
        kept = ArrayCache(ARRAY_CACHE_BYTES)
        index = VectorIndex(on_change=kept.forget)
        store = Store.open(settings.database, settings.files_dir, library_id)
        return cls(
            settings=settings,
            store=store,
            health=Health(store),
            index=index,
            arrays=kept,
            models=FittedModels(),
            word_scores=ModelRows(),
            symbol_points=ModelRows(),
            pool=AnalysisPool(query_limits(settings)),
            windows={
                scale.name: VectorIndex(layout=parts_layout(scale.vectors, scale.spans, WIDTH))
                for scale in WINDOW_SCALES
            },
            segments=VectorIndex(
                layout=parts_layout(SEGMENT_VECTORS, SEGMENT_SPANS, SEGMENT_WIDTH)
            ),
            poses=VectorIndex(layout=POSES),
            metrics={kind: ProjectedIndex(index) for kind in METRICS},
        )

    def close(self) -> None:
        """Stop the analysis processes and give back the connections."""
        self.pool.close()
        self.store.close()


def query_limits(settings: Settings) -> Limits:
    """What the analysis of an uploaded query may take."""
    return Limits(
        settings.query_timeout_s,
        settings.analysis_memory_mb,
        settings.max_frames,
        settings.max_joints,
    )


def ingest_limits(settings: Settings) -> Limits:
    """What the analysis of a clip may take."""
    return Limits(
        settings.analysis_timeout_s,
        settings.analysis_memory_mb,
        settings.max_frames,
        settings.max_joints,
    )
