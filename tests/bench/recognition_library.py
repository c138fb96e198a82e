"""The real clips for the bench of recognition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from app.analysis.analyze import describe_for_search
from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.segments.danced_cycles import DancedCycles, danced_cycles
from app.analysis.segments.keypose_arrays import keypose_arrays
from app.formats.read import read_recording
from app.models.folds import recording_of
from app.models.recognition.copies import ClipCopies, disturbed_copies, evenly_chosen
from app.models.recognition.views import full_samples
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_track
from tests.real_clips import manifest, real_clips


@dataclass(frozen=True)
class Library:
    samples: np.ndarray
    persons: list[str | None]
    tasks: list[str]
    groups: list[str]
    takes: np.ndarray
    """Take of a dataset-2 clip, 1..5; 0 for the others."""
    wide: np.ndarray
    angles: np.ndarray
    cycles: list[DancedCycles]
    copies_of: Callable[[int], np.ndarray]
    """The disturbed copies of a clip."""

    def copies(self, chosen: np.ndarray) -> ClipCopies:
        """The copies that the default method learns from, of some clips."""
        index = np.flatnonzero(chosen)
        copied = set(evenly_chosen(len(index)).tolist())
        return [self.copies_of(int(i)) if n in copied else None for n, i in enumerate(index)]

    @property
    def full(self) -> np.ndarray:
        return full_samples(self.samples, self.wide)

    def part(
        self, chosen: np.ndarray, method: str = "default"
    ) -> tuple[np.ndarray, list[str | None], list[str]]:
        """The samples that a method learns from, of some clips, and their labels."""
        index = np.flatnonzero(chosen)
        who, what = [self.persons[i] for i in index], [self.tasks[i] for i in index]
        given = {"default": self.full, "signatures": self.angles}.get(method, self.samples)
        return given[index], who, what


def read_library() -> Library:
    """The real BVH clips, analyzed."""
    rows = [row for row in manifest() if row["path"].endswith(".bvh")]
    second = [row["path"].startswith("bandai-namco-2") for row in rows]
    takes = [int(r["path"][-7:-4]) if s else 0 for r, s in zip(rows, second, strict=True)]
    clips = [_arrays(row["path"], float(row["fps"])) for row in rows]
    return Library(
        np.stack([arrays["motion_sample"] for arrays in clips]),
        [row["person"] or None for row in rows],
        [row["task"] for row in rows],
        [recording_of(row["path"]) for row in rows],
        np.array(takes),
        np.stack([arrays["wide_motion_vector"] for arrays in clips]),
        np.stack([arrays["angle_sample"] for arrays in clips]),
        [danced_cycles(arrays) for arrays in clips],
        cache(lambda i: disturbed_copies(clips[i]["role_positions"], i)),
    )


def _arrays(path: str, fps: float) -> dict[str, np.ndarray]:
    recording = read_recording((real_clips() / path).read_bytes())
    motion = canonicalize(recording, frame_rate=fps)
    arrays = describe_for_search(motion).arrays
    return arrays | keypose_arrays(
        find_keyposes(body_track(motion)).frames, arrays["features_10hz"]
    )
