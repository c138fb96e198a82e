"""Ready clips that are so long that comparing two of them takes minutes, for tests of overload."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import insert, update

from app.analysis.analyze import ANALYSIS_VERSION
from app.config import Settings
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.store import identity
from app.store.clips import arrays
from app.store.clips.index_feed import IndexedClip
from app.store.database import tables as t
from app.store.store import Store
from tests.bench.large_library import clip_row
from tests.bodies import walking

FRAMES = 60_000
"""Their positions do not fit into the buffers of a connection whose client does not read."""
COMPARED = 150_000
"""Length of the secondary vector of a clip: to warp two of them takes minutes."""
COUNT = 3


def long_library(data_dir: Path) -> list[str]:
    """Write COUNT ready clips into a new library, and return their ids."""
    settings = Settings(data_dir=data_dir)
    data_dir.mkdir(parents=True, exist_ok=True)
    identity.prepare(settings.database, settings.files_dir)
    store = Store.open(settings.database, settings.files_dir)
    names = [role.value for role in SUN_ROLES]
    changes = {"roles": {n: n for n in names}, "frames": FRAMES, "joints": len(names)}
    clips = [_indexed(number) for number in range(1, COUNT + 1)]
    with store.write() as tx:
        for number, clip in enumerate(clips, 1):
            tx.execute(insert(t.clips), [clip_row(number, clip) | changes])
            arrays.put_many(tx, clip.id, _arrays(number), version=ANALYSIS_VERSION)
        tx.execute(update(t.library).values(version=COUNT))
    store.close()
    return [clip.id for clip in clips]


def _indexed(number: int) -> IndexedClip:
    return IndexedClip(
        id=f"clip_{number:020x}",
        is_ready=True,
        person="ada",
        task="walk",
        license=None,
        source=None,
        duration=FRAMES / 30,
        words=frozenset(),
        array=None,
    )


def _arrays(number: int) -> dict[str, Any]:
    rng = np.random.default_rng(number)
    body = walking(FRAMES / 30)[:FRAMES].astype(np.float32)
    return {
        "motion_vector": rng.normal(size=128).astype(np.float32),
        "paced_vector": rng.normal(size=128).astype(np.float32),
        "features_10hz": rng.normal(size=(100, 82)).astype(np.float32),
        "active_span": np.array([0.0, FRAMES / 30], dtype=np.float32),
        "msv_rho": rng.normal(size=13).astype(np.float32),
        "msv_epsilon": rng.normal(size=COMPARED).astype(np.float32),
        "role_positions": body,
        "positions": body,
        "parents": np.array(SUN_PARENTS, dtype=np.int32),
        "joint_names": np.frombuffer(
            json.dumps([role.value for role in SUN_ROLES]).encode(), dtype=np.uint8
        ),
    }
