"""Reads FBX 6 and 7, binary and text: limb nodes and their animation. Bytes in, Recording out.

At rest, the frames of all joints have the axes of the world, as in BVH. The rest pose is the pose
by pre-rotations alone. Without pre-rotations it is the pose in which the nodes were saved. The
result has Y up and is right-handed, whatever axes the file has.

Source: Autodesk FBX SDK 2020 reference. The formulas are in `transforms.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.common.stacks import choose_stack, stack_caution
from app.formats.common.world_positions import MAX_JOINT_FRAMES, Solved, solve
from app.formats.fbx.animation import Stack, find_stacks
from app.formats.fbx.curves import KTIME
from app.formats.fbx.objects import Numbers
from app.formats.fbx.opening import open_fbx
from app.formats.fbx.scene import FbxScene
from app.formats.fbx.skeleton import Body, find_body
from app.formats.fbx.timing import Timing, find_timing, key_span
from app.formats.fbx.transforms import (
    ANIMATED_PROPERTIES,
    FbxNode,
    Local,
    World,
    read_node,
    world_transforms,
)
from app.motion.skeleton.recording import Caution, Recording
from app.motion.skeleton.rotations import matrices_to_quaternions, multiply, rotate
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray

METERS_PER_CENTIMETER = 0.01
"""UnitScaleFactor gives the unit in centimeters."""
SCALES = (1e-6, 1e3)
"""The smallest and the largest plausible number of meters per unit."""
MAX_STILL_SHARE = 1e-5
"""Translations that change by less than this share of the skeleton's size count as constant."""

_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


def read_fbx(content: bytes, stack: str | None = None) -> Recording:
    """Read an FBX file.

    stack: the name of the animation stack; by default the longest one is read. Raises
    FormatNotSupported for encryption, other versions and unsupported properties, Unreadable with
    the node or byte, BadField for a stack that does not exist, and TooLarge.
    """
    scene = FbxScene(open_fbx(content))
    stacks = find_stacks(scene)
    if not stacks:
        raise unreadable_at("node Objects/AnimationStack", "expected an animation, found none")
    body = find_body(scene, set().union(*(one.moving() for one in stacks)))
    times = [one.key_times(body.nodes) for one in stacks]
    # A stack without keys that move the body has no span and counts as the shortest.
    spans = [_span(scene, one, found) for one, found in zip(stacks, times, strict=True)]
    lengths = [span[1] - span[0] if span else -1.0 for span in spans]
    names = [one.stack.name for one in stacks]
    chosen = choose_stack(names, lengths, stack)
    span = spans[chosen]
    if span is None:
        raise stacks[chosen].stack.unreadable("expected keys that move joints, found none")
    timing = find_timing(times[chosen], span, scene.settings)
    cautions = body.cautions + timing.cautions + stack_caution(names, lengths, chosen)
    return _recording(scene, body, stacks[chosen], timing, cautions)


def _span(scene: FbxScene, stack: Stack, times: list[IntArray]) -> tuple[float, float] | None:
    start, stop = (scene.ticks(stack.stack, name) for name in ("LocalStart", "LocalStop"))
    return key_span(times, start, stop)


@dataclass(frozen=True, slots=True)
class _Motion:
    """The nodes of a body and their channels.

    channels: for each node the translation, the rotation in degrees, and the scale, each (frames,
    3), or (1, 3) if it does not change.
    """

    nodes: list[FbxNode]
    parents: IntArray
    channels: list[tuple[FloatArray, ...]]
    frames: int

    def local(self, block: slice) -> Local:
        """The local transforms of the frames in `block`."""
        count = len(range(self.frames)[block])
        values = [[c if len(c) == 1 else c[block] for c in one] for one in self.channels]
        return self._assembled(values, count)

    def rest(self) -> Local:
        """The local transforms at rest, as one frame.

        Translations and scales are those of the first frame.
        """
        turned = any(np.any(node.before) for node in self.nodes)
        values = [
            [moved[:1], (np.zeros((1, 3)) if turned else node.still[1][None]), scaled[:1]]
            for node, (moved, _, scaled) in zip(self.nodes, self.channels, strict=True)
        ]
        return self._assembled(values, 1)

    def _assembled(self, values: list[list[FloatArray]], count: int) -> Local:
        shape = (count, len(self.nodes))
        local = Local(np.empty((*shape, 3)), np.empty((*shape, 4)), np.empty((*shape, 3)))
        for index, (node, (moved, degrees, scale)) in enumerate(
            zip(self.nodes, values, strict=True)
        ):
            local.rotations[:, index] = node.local_rotations(degrees.astype(np.float64))
            local.scales[:, index] = scale
            turned, scales = local.rotations[:, index], local.scales[:, index]
            local.translations[:, index] = node.origin(moved.astype(np.float64), turned, scales)
        return local

    def world(self, local: Local) -> World:
        """The world transforms for some local transforms."""
        return world_transforms(self.nodes, self.parents, local)


def _recording(
    scene: FbxScene, body: Body, stack: Stack, timing: Timing, cautions: tuple[Caution, ...]
) -> Recording:
    frames = len(timing.ticks)
    if frames * len(body.nodes) > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} joints times frames")
    # The numbers of a broken file may overflow. The result is checked below.
    with np.errstate(all="ignore"):
        motion = _read_motion(scene, body, stack, timing)
        rest = _Rest(motion, body, axes(scene.settings))
        solved = solve(rest.skeleton, frames, rest.local_pose, moving=rest.moving())
    _refuse_large_numbers(solved)
    factor = scene.settings.get("UnitScaleFactor", (np.nan,))[0] * METERS_PER_CENTIMETER
    return Recording(
        format="fbx",
        skeleton=rest.skeleton,
        positions=solved.positions,
        rotations=solved.rotations,
        translations=solved.translations,
        frame_rate=timing.frame_rate,
        up_axis="y",
        is_up_axis_said="UpAxis" in scene.settings,
        metres_per_unit=factor if SCALES[0] <= factor <= SCALES[1] else None,
        cautions=cautions,
        start_frame=float(timing.ticks[0]) / KTIME * timing.frame_rate,
    )


def _read_motion(scene: FbxScene, body: Body, stack: Stack, timing: Timing) -> _Motion:
    stack.refuse_unsupported(body.nodes)
    nodes = [read_node(scene, node) for node in body.nodes]
    read = partial(stack.channel, scene)
    channels = [
        tuple(
            read(node.node, name, still, timing.ticks)
            for name, still in zip(ANIMATED_PROPERTIES, node.still, strict=True)
        )
        for node in nodes
    ]
    return _Motion(nodes, body.parents, channels, len(timing.ticks))


class _Rest:
    """A motion relative to its rest pose, with Y up.

    At rest, the frames of joints have the axes of the world. turn: (3, 3) from the axes of the file
    to X right, Y up, Z to the viewer.
    """

    def __init__(self, motion: _Motion, body: Body, turn: FloatArray) -> None:
        self.motion = motion
        self.joints = np.flatnonzero(body.is_joint)
        self.parents = _parents_among(self.joints, body.parents)
        self.turn = turn
        # Conjugation by -turn and by turn is the same, so a mirrored turn also has a quaternion.
        self.turn_quaternion = matrices_to_quaternions(turn * np.sign(np.linalg.det(turn)))
        world = motion.world(motion.rest())
        self.unturned = world.rotations[:, self.joints] * _CONJUGATE
        positions = world.positions[0, self.joints] @ turn.T
        below = self.parents >= 0
        positions[below] -= positions[self.parents[below]]
        names = tuple(body.nodes[index].name or f"joint {index}" for index in self.joints)
        self.skeleton = Skeleton(names, self.parents, positions)

    def local_pose(self, block: slice) -> tuple[FloatArray, FloatArray]:
        """Local rotations (n, joints, 4) and translations (n, joints, 3) of a block of frames."""
        world = self.motion.world(self.motion.local(block))
        # world rotations (n, joints, 4) relative to rest, then in the turned axes
        turned = multiply(world.rotations[:, self.joints], self.unturned)
        turned = multiply(multiply(self.turn_quaternion, turned), self.turn_quaternion * _CONJUGATE)
        moved = world.positions[:, self.joints] @ self.turn.T
        below = np.flatnonzero(self.parents >= 0)
        above = turned[:, self.parents[below]] * _CONJUGATE
        rotations, translations = turned.copy(), moved.copy()
        rotations[:, below] = multiply(above, turned[:, below])
        translations[:, below] = rotate(above, moved[:, below] - moved[:, self.parents[below]])
        return rotations, translations

    def moving(self) -> bool:
        """Whether joints below the root move relative to their parents."""
        motion, root = self.motion, int(self.joints[0])
        limit = MAX_STILL_SHARE * max(float(np.abs(self.skeleton.offsets).max()), 1e-12)
        scaled = any(not np.allclose(scale, scale[0, 0]) for _, _, scale in motion.channels)
        return scaled or any(
            motion.nodes[index].has_pivots
            or np.ptp(motion.channels[index][0], axis=0).max() > limit
            for index in range(root + 1, len(motion.nodes))
        )


def _parents_among(joints: IntArray, parents: IntArray) -> IntArray:
    """(joints,) the parents of joints as indices of joints, -1 for the root.

    joints: (joints,) indices of nodes. parents: (nodes,). All nodes between joints are joints.
    """
    new = {int(old): index for index, old in enumerate(joints)}
    return np.array([new.get(int(parents[index]), -1) for index in joints], dtype=np.int64)


def axes(settings: dict[str, Numbers]) -> FloatArray:
    """(3, 3) the matrix from the axes of a file to X right, Y up, Z to the viewer.

    settings: the numbers of GlobalSettings. The determinant is -1 for a left-handed file, so that
    the body is not mirrored. Raises Unreadable if the axes are not three different ones.
    """
    turn = np.zeros((3, 3))
    for row, (name, usual) in enumerate((("CoordAxis", 0), ("UpAxis", 1), ("FrontAxis", 2))):
        axis = settings.get(name, (float(usual),))[0]
        sign = settings.get(f"{name}Sign", (1.0,))[0]
        if axis in (0, 1, 2) and sign in (-1, 1):
            turn[row, int(axis)] = sign
    if abs(np.linalg.det(turn)) != 1:
        raise unreadable_at("node GlobalSettings", "expected three different axes")
    return turn


def _refuse_large_numbers(solved: Solved) -> None:
    for numbers in (solved.positions, solved.rotations):
        if not np.all(np.abs(numbers) <= MAX_MAGNITUDE):
            raise unreadable_at(
                "node Objects/Model", f"expected positions within ±{MAX_MAGNITUDE:g}"
            )
