"""The real BVH clips, analyzed once for all benches that need no library."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from app.analysis.analyze import describe_for_search
from app.formats.read import read_recording
from app.models.folds import recording_of
from app.models.metric.learned_metric import INPUTS, ClipDescriptors
from app.motion.canonical.canonical import canonicalize
from tests.real_clips import manifest, real_clips


@dataclass(frozen=True)
class RealClips:
    """n clips.

    takes: (n,) the take 1..5 of a clip of dataset 2, else 0; arrays: of each clip, by name.
    """

    folders: np.ndarray
    persons: np.ndarray
    tasks: np.ndarray
    recordings: np.ndarray
    takes: np.ndarray
    arrays: list[dict[str, np.ndarray]]

    def __len__(self) -> int:
        return len(self.arrays)

    @property
    def described(self) -> ClipDescriptors:
        return ClipDescriptors(*(self.column(name) for name in INPUTS))

    def column(self, name: str) -> np.ndarray:
        return np.stack([arrays[name] for arrays in self.arrays]).astype(np.float64)

    def part(self, chosen: np.ndarray) -> RealClips:
        index = np.flatnonzero(chosen)
        columns = (self.folders, self.persons, self.tasks, self.recordings, self.takes)
        return RealClips(*(c[index] for c in columns), [self.arrays[i] for i in index])


@lru_cache(maxsize=1)
def described_clips() -> RealClips:
    rows = [row for row in manifest() if row["path"].endswith(".bvh")]
    folders = np.array([row["path"].partition("/")[0] for row in rows])
    takes = [
        int(r["path"][-7:-4]) if f.endswith("-2") else 0 for r, f in zip(rows, folders, strict=True)
    ]
    return RealClips(
        folders,
        np.array([row["person"] for row in rows]),
        np.array([row["task"] for row in rows]),
        np.array([recording_of(row["path"]) + row["path"].partition("/")[0] for row in rows]),
        np.array(takes),
        [_arrays(row["path"], float(row["fps"])) for row in rows],
    )


def _arrays(path: str, fps: float) -> dict[str, np.ndarray]:
    recording = read_recording((real_clips() / path).read_bytes())
    return dict(describe_for_search(canonicalize(recording, frame_rate=fps)).arrays)
