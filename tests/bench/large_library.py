"""Libraries of many clips: copies of real clips with noise on their vectors, written into a store.

We do not have a hundred thousand recordings, and a search does not need them. The limbs of a copy
are moved, so that no two copies have the same poses. The other arrays of a copy (features, volumes)
are those of its real clip, so its length is realistic.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy import insert, update

from app.analysis.analyze import ANALYSIS_VERSION, analyze
from app.errors import BadContent
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.store.clips.index_feed import IndexedClip
from app.store.clips.measures import FOUND
from app.store.clips.record import ClipState
from app.store.database import tables as t
from app.store.database.blobs import to_blob
from app.store.database.ids import utc_now
from app.store.store import Store
from tests.bench.moved_limbs import Limbs
from tests.real_clips import manifest, real_clips

VECTOR = "motion_vector"
POSITIONS, COVER = "role_positions", "pose_cover"
SPREAD = 0.03
"""Deviation of the noise on each number of a vector: a third of the median distance to the nearest
neighbor."""
PEOPLE, STYLES = 50, 8
"""Numbers of invented persons and of invented words. Each clip carries two words."""
AT_ONCE = 2000
NOT_SEARCHED = ("positions", "symbol_means", "symbol_variances", "symbol_transitions")
"""Arrays that no search by example or by pose reads. They would fill the disk."""


@dataclass(frozen=True)
class Sample:
    """A real clip: its task and duration, and its arrays."""

    task: str
    duration: float
    arrays: dict[str, Any]

    @functools.cached_property
    def blobs(self) -> list[dict[str, Any]]:
        """Rows of the table of arrays that all copies share, without the clip's id."""
        return [
            {"name": name, "version": ANALYSIS_VERSION, **to_blob(array)}
            for name, array in self.arrays.items()
            if name not in (VECTOR, POSITIONS, COVER, *NOT_SEARCHED)
        ]

    @functools.cached_property
    def limbs(self) -> Limbs:
        """Makes the poses of copies."""
        return Limbs.of(self.arrays[POSITIONS], self.arrays[COVER])


@functools.lru_cache(maxsize=1)
def samples(every: int = 3) -> tuple[Sample, ...]:
    """Analyze every `every`-th real clip."""
    found = []
    for row in manifest()[::every]:
        try:
            recording = read_recording((real_clips() / row["path"]).read_bytes())
            motion = canonicalize(recording, frame_rate=float(row["fps"]))
            found.append(Sample(row["task"], motion.duration, dict(analyze(motion).arrays)))
        except BadContent:
            continue
    return tuple(found)


def many_clips(
    count: int, seed: int = 0, real: Sequence[Sample] = ()
) -> Iterator[tuple[Sample, IndexedClip]]:
    """Yield `count` copies of samples, each with its own vector, labels and measures.

    real: the samples; default: those of the real clips.
    """
    rng = np.random.default_rng(seed)
    measures = np.random.default_rng(seed)
    real = real or samples()
    vectors = np.stack([sample.arrays[VECTOR] for sample in real])
    for first in range(0, count, AT_ONCE):
        chosen = rng.integers(len(real), size=min(AT_ONCE, count - first))
        noise = rng.normal(scale=SPREAD, size=(len(chosen), vectors.shape[1]))
        made = (vectors[chosen] + noise).astype(np.float32)
        people = rng.integers(PEOPLE, size=len(chosen))
        words = rng.integers(STYLES, size=(len(chosen), 2))
        for offset, sample in enumerate(chosen):
            yield (
                real[sample],
                IndexedClip(
                    id=f"clip_{first + offset:020x}",
                    is_ready=True,
                    person=f"person {people[offset]}",
                    task=real[sample].task,
                    license="CC0-1.0",
                    source="bench",
                    duration=real[sample].duration,
                    words=frozenset(f"word{word}" for word in words[offset]),
                    array=made[offset],
                    measures=(30.0, 22.0, *measures.gamma(2.0, size=3).tolist(), 120.0),
                ),
            )


def fill(
    store: Store, count: int, names: Sequence[str] | None = None, real: Sequence[Sample] = ()
) -> None:
    """Write `count` ready clips into an empty store.

    names: the arrays to write; default: all arrays that searches read. real: as of `many_clips`.
    """
    clips, rng = enumerate(many_clips(count, real=real), 1), np.random.default_rng(count)
    while batch := list(itertools.islice(clips, AT_ONCE)):
        with store.write() as tx:
            tx.execute(insert(t.clips), [clip_row(number, made) for number, (_, made) in batch])
            tx.execute(insert(t.clip_words), list(_word_rows(made for _, (_, made) in batch)))
            rows = (_array_rows(sample, made, names, rng) for _, (sample, made) in batch)
            tx.execute(insert(t.clip_arrays), list(itertools.chain.from_iterable(rows)))
            tx.execute(update(t.library).values(version=batch[-1][0]))


def clip_row(number: int, clip: IndexedClip) -> dict[str, Any]:
    return {
        "id": clip.id,
        "content_key": f"{number:064x}",
        "sha256": f"{number:064x}",
        "file_name": f"{clip.id}.bvh",
        "file_size": 1,
        "name": f"clip {number}",
        "name_folded": f"clip {number}",
        "state": ClipState.READY.value,
        "format": "bvh",
        "person": clip.person,
        "task": clip.task,
        "license": clip.license,
        "source": clip.source,
        "frames": round(clip.duration * 30),
        "declared_frame_rate": 30.0,
        "duration": clip.duration,
        **dict(zip(FOUND, clip.measures, strict=True)),
        "metres_per_unit": 0.01,
        "roles": {"hips": "Hips", "head": "Head", "neck": "Neck"},
        "missing_roles": [],
        "warnings": [],
        "analysis_version": ANALYSIS_VERSION,
        "changed_version": number,
        "created_at": utc_now(),
    }


def _word_rows(clips: Iterator[IndexedClip]) -> Iterator[dict[str, Any]]:
    for clip in clips:
        for position, word in enumerate(sorted(clip.words)):
            yield {"clip_id": clip.id, "word": word, "position": position}


def _array_rows(
    sample: Sample, clip: IndexedClip, names: Sequence[str] | None, rng: np.random.Generator
) -> Iterator[dict[str, Any]]:
    assert clip.array is not None
    own = {VECTOR: clip.array}
    if names is None or POSITIONS in names or COVER in names:
        own[POSITIONS], own[COVER] = sample.limbs.moved(rng)
    for name, array in own.items():
        if name == VECTOR or names is None or name in names:
            row = {"clip_id": clip.id, "name": name, "version": ANALYSIS_VERSION}
            yield row | to_blob(array)
    for blob in sample.blobs:
        if names is None or blob["name"] in names:
            yield {"clip_id": clip.id, **blob}
