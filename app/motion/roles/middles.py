"""Joints in the middle of two others, for roles that have no joint of their own.

COCO and MediaPipe bodies have no hips and no neck, but both hip joints and both shoulders. A client
may also name two joints for a role. The middle becomes a joint of the recording.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from app.motion.roles.added_joints import with_joints
from app.motion.roles.joint_names import side_and_word
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution, Recording

_R = JointRole
_MIDDLE_OF: dict[JointRole, tuple[JointRole, JointRole]] = {
    _R.HIPS: (_R.LEFT_UPPER_LEG, _R.RIGHT_UPPER_LEG),
    _R.NECK: (_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER),
}
"""The roles whose middle stands for a role that has no joint."""
_EARS = ("ear", "earlobe")
"""The middle of both ears is nearer to the middle of the head than the nose is."""

Joints = tuple[int, ...]
"""One joint, or two joints whose middle is used."""


def with_given_middles(
    recording: Recording, given: Mapping[JointRole, Joints]
) -> tuple[Recording, dict[JointRole, int]]:
    """The recording with a joint for each role of two joints, and one joint for each role."""
    pairs = {role: joints for role, joints in given.items() if len(joints) > 1}
    recording, roles = _with_middles(recording, pairs)
    return recording, {role: roles.get(role, joints[0]) for role, joints in given.items()}


def with_missing_middles(
    recording: Recording, found: Mapping[JointRole, int]
) -> tuple[Recording, dict[JointRole, int], tuple[Caution, ...]]:
    """The recording with middle joints for hips, neck and head that were not found.

    found: the joint of each role. The caution names the joints that were made.
    """
    pairs = {
        role: (found[left], found[right])
        for role, (left, right) in _MIDDLE_OF.items()
        if role not in found and left in found and right in found
    }
    ears = _ears(recording.skeleton.names)
    if ears and _names_only_the_nose(recording.skeleton.names, found):
        pairs[_R.HEAD] = ears
    if not pairs:
        return recording, dict(found), ()
    names = recording.skeleton.names
    made = [f"{role} between {names[a]} and {names[b]}" for role, (a, b) in pairs.items()]
    detail = f"joints were made in the middle of two others: {', '.join(made)}"
    recording, more = _with_middles(recording, pairs)
    roles = dict(found) | more
    ordered = {role: roles[role] for role in JointRole if role in roles}
    first = recording.skeleton.names[next(iter(more.values()))]
    return recording, ordered, (Caution("joints_made", detail, joint=first),)


def _ears(names: Sequence[str]) -> tuple[int, int] | None:
    keys = [side_and_word(name) for name in names]
    for word in _EARS:
        if ("left", word) in keys and ("right", word) in keys:
            return keys.index(("left", word)), keys.index(("right", word))
    return None


def _names_only_the_nose(names: Sequence[str], found: Mapping[JointRole, int]) -> bool:
    head = found.get(_R.HEAD)
    return head is None or side_and_word(names[head])[1] == "nose"


def _with_middles(
    recording: Recording, pairs: Mapping[JointRole, Sequence[int]]
) -> tuple[Recording, dict[JointRole, int]]:
    """The recording with a joint in the middle of each pair, and these joints."""
    tracks = {role: recording.positions[:, list(pair)].mean(axis=1) for role, pair in pairs.items()}
    return with_joints(recording, tracks, "middle")
