"""A library of many clips to fit models on: disturbed copies of the real clips.

Each number that a model reads gets noise of NOISE times its standard deviation over the real clips,
so that no two clips are equal. Copies belong to three times as many persons as the real clips have.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from sqlalchemy import insert, update

from app.analysis.analyze import ANALYSIS_VERSION, analyze
from app.errors import BadContent
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.store.clips.index_feed import IndexedClip
from app.store.database import tables as t
from app.store.database.blobs import to_blob
from app.store.store import Store
from tests.bench.large_library import clip_row
from tests.real_clips import manifest, real_clips

NOISE = 0.15
PERSONS = 3
"""The person of every third copy is the same."""
AT_ONCE = 500
DISTURBED = (
    *("symbol_means", "symbol_statistics", "movement_signs", "motion_sample", "motion_vector"),
    *("wide_motion_vector", "angle_sample", "motion_shape"),
)
KEPT = ("symbol_variances", "symbol_transitions", "role_positions")

Labels = dict[str, str]
Arrays = dict[str, Any]


@lru_cache(maxsize=1)
def _real() -> list[tuple[Labels, float, Arrays]]:
    """The row of the manifest, the duration and the arrays of each real BVH clip."""
    found = []
    for row in manifest():
        try:
            recording = read_recording((real_clips() / row["path"]).read_bytes())
        except BadContent:
            continue
        motion = canonicalize(recording, frame_rate=float(row["fps"]))
        arrays = analyze(motion).arrays
        found.append((row, motion.duration, {name: arrays[name] for name in (*DISTURBED, *KEPT)}))
    return found


def fill_for_fits(store: Store, count: int, seed: int = 0) -> None:
    """Write `count` ready clips into an empty store; the first ones are the real clips."""
    rng = np.random.default_rng(seed)
    for first in range(0, count, AT_ONCE):
        numbers = range(first, min(first + AT_ONCE, count))
        made = [(number, *_copy(number, rng)) for number in numbers]
        with store.write() as tx:
            tx.execute(insert(t.clips), [clip_row(number + 1, clip) for number, clip, _ in made])
            words = [
                {"clip_id": clip.id, "word": word, "position": position}
                for _, clip, _ in made
                for position, word in enumerate(sorted(clip.words))
            ]
            tx.execute(insert(t.clip_words), words)
            tx.execute(insert(t.clip_arrays), [row for _, c, a in made for row in _rows(c.id, a)])
            tx.execute(update(t.library).values(version=numbers[-1] + 1))


def _copy(number: int, rng: np.random.Generator) -> tuple[IndexedClip, Arrays]:
    real, spreads = _real(), _spreads()
    copy, which = divmod(number, len(real))
    row, duration, arrays = real[which]
    if copy:
        arrays = dict(arrays)
        for name in DISTURBED:
            noise = rng.normal(scale=NOISE, size=arrays[name].shape) * spreads[name]
            arrays[name] = (arrays[name] + noise).astype(np.float32)
    clip = IndexedClip(
        id=f"clip_{number:020x}",
        is_ready=True,
        person=row["person"] + " again" * (copy % PERSONS) if row["person"] else None,
        task=row["task"] or None,
        license=row["license"],
        source=row["source"],
        duration=duration,
        words=frozenset(row["words"].split()),
        array=None,
        measures=(30.0, 22.0, 1.0, 1.0, 1.0, 120.0),
    )
    return clip, arrays


@lru_cache(maxsize=1)
def _spreads() -> dict[str, Any]:
    """The noise of each number. A shape ends with whether it is a cycle, which has none."""
    spreads: dict[str, Any] = {"symbol_means": 1.0}
    for name in DISTURBED[1:]:
        spreads[name] = np.stack([arrays[name] for _, _, arrays in _real()]).std(axis=0)
    spreads["motion_shape"][-1] = 0.0
    return spreads


def _rows(clip_id: str, arrays: Arrays) -> Iterator[dict[str, Any]]:
    for name, array in arrays.items():
        blob = to_blob(np.asarray(array))
        yield {"clip_id": clip_id, "name": name, "version": ANALYSIS_VERSION, **blob}
