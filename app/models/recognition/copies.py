"""Disturbed copies of clips, from which the recognizer learns what must not matter.

A copy has the person and the task of its clip; a mirrored one has the task of the other side
(app.models.recognition.mirrored_cells). The difference between both says how much noise, a
wrong speed or a lost start changes the description of a motion. Copies are no takes: they say
nothing about how a person varies, and a library with one take of each cell has them too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.analyze import describe_for_search
from app.errors import TooShort
from app.models.recognition.disturbances import (
    Disturb,
    faster,
    jitter,
    kept,
    mirrored,
    noise,
)
from app.models.recognition.kinds import Disturbed
from app.models.recognition.views import BothViews
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.numerics.arrays import FloatArray, IntArray

LIGHT: tuple[Disturb, ...] = (jitter(1.0), noise(6.0), faster(1.25), faster(0.8))
"""Disturbances that leave the whole motion."""

CUTS: tuple[Disturb, ...] = (kept(0.15, 0.85), kept(0.25, 0.75))
"""Disturbances that take away its start and end."""

DISTURBANCES = (*LIGHT, *CUTS, mirrored)
"""The copies of a clip, in this order."""

MAX_COPIED = 200
"""The largest number of clips that are copied, since describing copies takes 70 ms of CPU time for
each clip. They only give a covariance, for which more clips are not needed."""

_INPUTS = ("motion_sample", "wide_motion_vector")

Moments = dict[Disturbed, FloatArray]
"""(d, d) second moments of the copies minus their clips, by kind of disturbance."""

ClipCopies = Sequence[FloatArray | None]
"""For each clip the full samples (7, 1762) of its DISTURBANCES, or None."""


def disturbed_copies(positions: FloatArray, seed: int = 0) -> FloatArray:
    """(7, 1762) full samples of the copies of a clip; float32.

    positions: (n, 13, 3) of the joints in SUN_ROLES order, meters, Y up, at ANALYSIS_RATE. A copy
    that is too short is the clip itself. Raises TooShort for a clip that is too short.
    """
    motion = _motion_of(positions)
    return np.stack([_described(disturb(motion, seed), motion) for disturb in DISTURBANCES])


def evenly_chosen(count: int) -> IntArray:
    """Indices of the clips to copy, of `count`: at most MAX_COPIED, evenly spread."""
    chosen = np.linspace(0, count - 1, min(count, MAX_COPIED))
    return np.asarray(np.unique(chosen.round()).astype(np.int64))


@dataclass(frozen=True, slots=True)
class CopiedClips:
    """m copied clips of n, in the coordinates of a recognizer's views.

    clips: (n, d) each view of all clips; copied: (m,) indices of the copied ones; copies: (m, 7, d)
    each view of their copies.
    """

    clips: BothViews
    copied: IntArray
    copies: BothViews

    def moments(self, among: IntArray) -> tuple[Moments, Moments]:
        """The moments of the copies of the clips `among`, for each view; empty without copies."""
        rows = np.flatnonzero(np.isin(self.copied, among))
        if not len(rows):
            return {}, {}
        originals = self.clips.of(self.copied[rows])
        sample, wide = (
            copies[rows] - clips[:, None]
            for copies, clips in zip(self.copies, originals, strict=True)
        )
        return _moments(sample), _moments(wide)

    def mirrored(self, among: IntArray) -> tuple[IntArray, BothViews]:
        """The mirrored copies of the copied clips `among`: the indices (k,) of their clips, and the
        copies (k, d)."""
        rows = np.flatnonzero(np.isin(self.copied, among))
        sample, wide = (copies[rows, -1] for copies in self.copies)
        return self.copied[rows], BothViews(sample, wide)

    def one_each(self, among: IntArray) -> tuple[IntArray, BothViews]:
        """One light copy of each copied clip `among`, the disturbances in turn: the indices (k,)
        of their clips, and the copies (k, d)."""
        rows = np.flatnonzero(np.isin(self.copied, among))
        turn = np.arange(len(rows)) % len(LIGHT)
        sample, wide = (copies[rows, turn] for copies in self.copies)
        return self.copied[rows], BothViews(sample, wide)


def _moments(differences: FloatArray) -> Moments:
    """The moments of `differences` (m, 7, d). A mirrored copy is another motion, with means of its
    own."""
    return {
        Disturbed.LIGHTLY: _second_moments(differences[:, : len(LIGHT)]),
        Disturbed.CUT: _second_moments(differences[:, : len(LIGHT) + len(CUTS)]),
    }


def _second_moments(differences: FloatArray) -> FloatArray:
    """(d, d) the mean outer product of `differences` (m, k, d)."""
    flat = differences.reshape(-1, differences.shape[-1])
    return np.asarray(flat.T @ flat / len(flat))


def _described(motion: Motion, otherwise: Motion) -> FloatArray:
    """(1762,) the full sample of `motion`, or of `otherwise` if it is too short."""
    try:
        arrays = describe_for_search(motion, _INPUTS).arrays
    except TooShort:
        arrays = describe_for_search(otherwise, _INPUTS).arrays
    return np.concatenate([arrays[name] for name in _INPUTS])


def _motion_of(positions: FloatArray) -> Motion:
    """The motion of the 13 joints alone."""
    return Motion(
        format="roles",
        names=tuple(role.value for role in SUN_ROLES),
        parents=np.array(SUN_PARENTS),
        positions=np.asarray(positions, dtype=np.float32),
        roles={role: index for index, role in enumerate(SUN_ROLES)},
        missing_roles=(),
        frame_rate=ANALYSIS_RATE,
        declared_frame_rate=None,
        metres_per_unit=1.0,
    )
