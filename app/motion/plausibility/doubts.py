"""Doubts about a body: whatever its format, each with the joints and the frames.

The limits are far from real bodies. In 501 real clips, the left and the right bone differ by at
most 6 %, chest and hips face ways with a cosine of at least .9, and knees and toes point forward
with a mean cosine of at least .3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

import numpy as np

from app.motion.motion import Motion
from app.motion.plausibility.sides import side_doubts
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.occlusion import runs
from app.motion.skeleton.recording import Caution
from app.motion.skeleton.resampling import some_frames
from app.numerics.arrays import BoolArray, FloatArray

MAX_SAMPLED_FRAMES = 64
"""The most frames, evenly spaced, in which lengths and sides are measured."""
MIN_MIRROR_RATIO = 0.75
"""The smallest ratio of the lengths of a left and a right bone (shorter / longer)."""
MAX_LENGTH_CHANGE, MIN_LENGTH_CHANGE = 0.5, 0.15
"""The largest change of a bone's length, as a share of its median, and the smallest one in meters
that is a doubt. Markers on skin, and joints that a camera sees, change by up to a fifth."""
MIN_FROZEN, MIN_TRAVEL = 0.3, 0.2
"""Seconds for which a marker does not move at all, and meters that the hips travel meanwhile."""
MAX_NAMED = 5
"""The most doubts of one kind in one clip."""

_R = JointRole
_SIDED = (("upper_leg", "knee"), ("knee", "foot"), ("shoulder", "elbow"), ("elbow", "hand"))
_MIDDLE = ((_R.HIPS, _R.NECK), (_R.NECK, _R.HEAD))
_Bone = tuple[JointRole, JointRole]
"""The upper and the lower end of a bone."""


def doubts_about(motion: Motion, *, is_rigid: bool) -> tuple[Caution, ...]:
    """The cautions about the body of `motion`, in meters, Y up.

    is_rigid: whether bones cannot change their lengths, as in a file of rotations.
    """
    sampled = some_frames(motion.positions, MAX_SAMPLED_FRAMES)
    bones = _bones(motion)
    lengths = _lengths(sampled if is_rigid else motion.positions, bones, motion)
    usual = np.median(some_frames(lengths, MAX_SAMPLED_FRAMES), axis=0)
    usual_lengths = dict(zip(bones, usual.tolist(), strict=True))
    found = [*_unequal_limbs(motion, usual_lengths), *side_doubts(motion, sampled)]
    if not is_rigid:
        found += islice(_length_jumps(motion, usual_lengths, lengths), MAX_NAMED)
        found += islice(_frozen_markers(motion), MAX_NAMED)
    return tuple(found)


def _bones(motion: Motion) -> list[_Bone]:
    """The bones both of whose ends were found."""
    sided = (
        (_R(f"{side}_{upper}"), _R(f"{side}_{lower}"))
        for side in ("left", "right")
        for upper, lower in _SIDED
    )
    roles = motion.roles
    return [bone for bone in (*_MIDDLE, *sided) if bone[0] in roles and bone[1] in roles]


def _lengths(positions: FloatArray, bones: Sequence[_Bone], motion: Motion) -> FloatArray:
    """(frames, bones) the lengths of bones in meters; positions: (frames, joints, 3)."""
    upper, lower = ([motion.roles[bone[end]] for bone in bones] for end in (0, 1))
    lines = positions[:, upper].astype(np.float64) - positions[:, lower]
    return np.asarray(np.sqrt(np.einsum("fbc,fbc->fb", lines, lines)))


def _unequal_limbs(motion: Motion, usual: Mapping[_Bone, float]) -> Iterator[Caution]:
    """usual: the median length of each bone in meters."""
    for bone, left in usual.items():
        other = (bone[0].mirrored(), bone[1].mirrored())
        if not bone[0].startswith("left_") or other not in usual:
            continue
        right = usual[other]
        if min(left, right) < MIN_MIRROR_RATIO * max(left, right):
            names = [motion.names[motion.roles[role]] for role in (*bone, *other)]
            yield Caution(
                "limbs_unequal",
                f"{names[0]} to {names[1]} has {left:.2f} m, but {names[2]} to {names[3]} has"
                f" {right:.2f} m",
                joint=names[1] if left < right else names[3],
            )


def _length_jumps(
    motion: Motion, usual: Mapping[_Bone, float], lengths: FloatArray
) -> Iterator[Caution]:
    """A caution for each bone whose length changes as that of no bone does.

    lengths: (frames, bones) in the order of `usual`.
    """
    medians = np.array(list(usual.values()))
    allowed = np.maximum(MAX_LENGTH_CHANGE * medians, MIN_LENGTH_CHANGE)
    changes = np.abs(lengths - medians)
    wrong = (changes > allowed) & (medians > 0)
    for index in np.flatnonzero(wrong.any(axis=0)).tolist():
        names = [motion.names[motion.roles[role]] for role in list(usual)[index]]
        frame = int(np.argmax(changes[:, index]))
        worst = lengths[frame, index]
        yield Caution(
            "bone_length_jumps",
            f"{names[0]} to {names[1]} has {medians[index]:.2f} m, but {worst:.2f} m in"
            f" {_frames(wrong[:, index])}",
            frames=next((start, end) for start, end in runs(wrong[:, index]) if frame < end),
            joint=names[1],
        )


def _frozen_markers(motion: Motion) -> Iterator[Caution]:
    """A caution for each marker that stays at one place while the body travels.

    Objects that never move are no markers of the body.
    """
    least = max(2, round(MIN_FROZEN * motion.frame_rate))
    if motion.frames <= least:
        return
    hips = motion.positions[:, motion.roles[_R.HIPS]]
    above = set(motion.parents.tolist())
    roots = np.flatnonzero(motion.parents < 0).tolist()
    single = np.array([joint for joint in roots if joint not in above], dtype=np.int64)
    # Two of these frames are in every run of `least` frames, so few markers remain.
    x = motion.positions[:: least // 2, single, 0]
    for joint in single[(x[1:] == x[:-1]).any(axis=0)].tolist():
        path = motion.positions[:, joint]
        still = np.all(path[1:] == path[:-1], axis=1)
        if still.all():
            continue
        for start, end in runs(still):
            travel = float(np.linalg.norm(hips[end] - hips[start]))
            if end - start + 1 >= least and travel >= MIN_TRAVEL:
                detail = (
                    f"{motion.names[joint]} does not move in frames {start} to {end}, while the"
                    f" hips travel {travel:.1f} m"
                )
                place = (start, end + 1)
                yield Caution("marker_frozen", detail, frames=place, joint=motion.names[joint])
                break


def _frames(wrong: BoolArray) -> str:
    """The runs of true values in words: "frames 20 to 34 and 3 more times"."""
    (first, end), *others = runs(wrong)
    where = f"frame {first}" if end - first == 1 else f"frames {first} to {end - 1}"
    return where + (f" and {len(others)} more times" if others else "")
