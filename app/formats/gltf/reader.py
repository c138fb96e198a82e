"""Reads the skeleton and the animation of GLB, glTF and VRM files. Bytes in, Recording out.

At rest, the frames of all joints have the axes of the world, as in BVH. The rest pose is the pose
in which the nodes were saved. Meters, Y up, as glTF requires.

pygltflib 1.16 brings seven packages, and returns bytes: the arrays, the keys, the tree and the
world positions would still be ours. trimesh 5 reads no animations.
Source: Khronos, "glTF 2.0 specification".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.common.stacks import choose_stack, stack_caution
from app.formats.common.world_positions import MAX_JOINT_FRAMES, Solved, solve
from app.formats.gltf.accessors import Accessors
from app.formats.gltf.container import Container, open_gltf
from app.formats.gltf.nodes import Body, find_body, still_transform
from app.formats.gltf.samplers import PATHS, Animation, find_animations, key_times, read_sampler
from app.formats.gltf.timing import frame_times, span_of
from app.motion.skeleton.kinematics import joints_by_depth
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import (
    conjugate,
    matrices_to_quaternions,
    multiply,
    quaternions_to_matrices,
    rotate,
)
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray

MIN_SCALE = 1e-12
"""A smaller scale counts as 0."""


def read_gltf(content: bytes, stack: str | None = None) -> Recording:
    """Read a GLB, glTF or VRM file.

    stack: the name of the animation; by default the longest one is read. Raises FormatNotSupported
    for glTF 1, for compressed numbers and for numbers in another file; Unreadable with the object
    of the file; BadField for an animation that does not exist; and TooLarge.
    """
    container = open_gltf(content)
    accessors = Accessors(container)
    animations = find_animations(container)
    if not animations:
        raise unreadable_at("animations", "expected an animation, found a model that does not move")
    body = find_body(container, set().union(*(one.nodes() for one in animations)))
    times = [_times(accessors, one, body) for one in animations]
    spans = [span_of(found) for found in times]
    lengths = [span[1] - span[0] if span else -1.0 for span in spans]
    names = [one.name for one in animations]
    chosen = choose_stack(names, lengths, stack)
    span = spans[chosen]
    if span is None:
        location = animations[chosen].location
        raise unreadable_at(location, "expected keys that move joints, found none")
    seconds, rate = frame_times(times[chosen], span)
    skeleton, solved = _solved(container, accessors, body, animations[chosen], seconds)
    return Recording(
        format="glb",
        skeleton=skeleton,
        positions=solved.positions,
        rotations=solved.rotations,
        translations=solved.translations,
        frame_rate=rate,
        up_axis="y",
        is_up_axis_said=True,
        metres_per_unit=1.0,
        cautions=body.cautions + stack_caution(names, lengths, chosen),
        start_frame=float(seconds[0]) * rate,
    )


def _solved(
    container: Container,
    accessors: Accessors,
    body: Body,
    animation: Animation,
    seconds: FloatArray,
) -> tuple[Skeleton, Solved]:
    """The skeleton and its motion at some times (frames,). Raises Unreadable, TooLarge."""
    if len(seconds) * len(body.nodes) > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} joints times frames")
    motion = _Motion(container, accessors, body, animation, seconds)
    with np.errstate(all="ignore"):  # the numbers of a broken file may overflow; checked below
        rest = _Rest(motion, body)
        solved = solve(rest.skeleton, len(seconds), rest.local_pose, moving=motion.moves_below())
    for numbers in (solved.positions, solved.rotations):
        if not np.all(np.abs(numbers) <= MAX_MAGNITUDE):
            raise unreadable_at("nodes", f"expected positions within ±{MAX_MAGNITUDE:g}")
    return rest.skeleton, solved


def _times(accessors: Accessors, animation: Animation, body: Body) -> list[FloatArray]:
    """The times of each sampler that moves the body, each array once."""
    nodes = set(body.nodes.tolist())
    samplers = {
        id(sampler): sampler for (node, _), sampler in animation.channels.items() if node in nodes
    }
    by_input = {str(_input(sampler)): sampler for sampler in samplers.values()}
    return [key_times(accessors, sampler, animation.location) for sampler in by_input.values()]


def _input(sampler: object) -> object:
    return sampler.get("input") if isinstance(sampler, dict) else None


@dataclass(slots=True)
class _Channels:
    """The properties of a node: (frames, n) each, or (1, n) if it does not change."""

    translation: FloatArray
    rotation: FloatArray
    scale: FloatArray


class _Motion:
    """The transforms of the nodes of a body over time."""

    def __init__(
        self,
        container: Container,
        accessors: Accessors,
        body: Body,
        animation: Animation,
        seconds: FloatArray,
    ) -> None:
        self.body = body
        self.frames = len(seconds)
        self.still = [
            still_transform(container.entry("nodes", node), node) for node in body.nodes.tolist()
        ]
        self.channels = []
        for node, still in zip(body.nodes.tolist(), self.still, strict=True):
            values = []
            for path, default in zip(PATHS, still, strict=True):
                sampler = animation.channels.get((node, path))
                if sampler is None:
                    values.append(default[None].astype(np.float32))
                    continue
                read = read_sampler(accessors, sampler, path, animation.location)
                values.append(_shortened(read.at(seconds).astype(np.float32)))
            self.channels.append(_Channels(*values))

    def moves_below(self) -> bool:
        """Whether joints below the root move relative to their parents."""
        has_joint_above = (self.body.parents >= 0) & self.body.is_joint[self.body.parents]
        below = [self.channels[joint] for joint in np.flatnonzero(has_joint_above)]
        scaled = any(len(one.scale) > 1 for one in self.channels)
        return scaled or any(len(one.translation) > 1 for one in below)

    def world(self, block: slice, count: int) -> FloatArray:
        """(count, nodes, 4, 4) the world matrices of the frames in `block`."""
        local = np.zeros((count, len(self.channels), 4, 4))
        for index, one in enumerate(self.channels):
            moved, turned, scaled = (
                values if len(values) == 1 else values[block]
                for values in (one.translation, one.rotation, one.scale)
            )
            _fill(local[:, index], moved, turned, scaled)
        return _gathered(local, self.body.parents)

    def rest(self) -> FloatArray:
        """(1, nodes, 4, 4) the world matrices of the nodes as they were saved."""
        local = np.zeros((1, len(self.still), 4, 4))
        for index, (moved, turned, scaled) in enumerate(self.still):
            _fill(local[:, index], moved[None], turned[None], scaled[None])
        return _gathered(local, self.body.parents)


def _shortened(values: FloatArray) -> FloatArray:
    """One row if all rows are equal."""
    return values[:1] if np.all(values == values[0]) else values


def _fill(local: FloatArray, moved: FloatArray, turned: FloatArray, scaled: FloatArray) -> None:
    """Set the matrices (frames, 4, 4) of translations, rotations x y z w and scales."""
    wxyz = turned[:, [3, 0, 1, 2]].astype(np.float64)
    length = np.linalg.norm(wxyz, axis=-1, keepdims=True)
    unit = np.where(length > MIN_SCALE, wxyz / np.maximum(length, MIN_SCALE), [1.0, 0, 0, 0])
    local[:, :3, :3] = quaternions_to_matrices(unit) * scaled[:, None, :]
    local[:, :3, 3] = moved
    local[:, 3, 3] = 1


def _gathered(local: FloatArray, parents: IntArray) -> FloatArray:
    world = local
    for nodes in joints_by_depth(parents)[1:]:
        world[:, nodes] = world[:, parents[nodes]] @ world[:, nodes]
    return world


class _Rest:
    """A motion relative to its rest pose. At rest, the frames of joints have the world's axes."""

    def __init__(self, motion: _Motion, body: Body) -> None:
        self.motion = motion
        self.joints = np.flatnonzero(body.is_joint)
        self.parents = _parents_among(self.joints, body.parents)
        world = motion.rest()[:, self.joints]
        self.unturned = conjugate(_rotations(world))
        positions = world[0, :, :3, 3]
        offsets = positions - np.where(
            self.parents[:, None] >= 0, positions[np.maximum(self.parents, 0)], 0.0
        )
        names = tuple(body.names[joint] for joint in self.joints)
        self.skeleton = Skeleton(names, self.parents, offsets)

    def local_pose(self, block: slice) -> tuple[FloatArray, FloatArray]:
        """Local rotations (n, joints, 4) and translations (n, joints, 3) of a block of frames."""
        count = len(range(self.motion.frames)[block])
        world = self.motion.world(block, count)[:, self.joints]
        turned = multiply(_rotations(world), self.unturned)
        moved = world[..., :3, 3]
        below = np.flatnonzero(self.parents >= 0)
        above = conjugate(turned[:, self.parents[below]])
        rotations, translations = turned.copy(), np.array(moved)
        rotations[:, below] = multiply(above, turned[:, below])
        translations[:, below] = rotate(above, moved[:, below] - moved[:, self.parents[below]])
        return rotations, translations


def _parents_among(joints: IntArray, parents: IntArray) -> IntArray:
    """(joints,) the parents of joints as indices of joints, -1 for a root.

    joints: (joints,) indices of nodes. parents: (nodes,). All nodes between joints are joints.
    """
    new = {int(node): index for index, node in enumerate(joints)}
    return np.array([new.get(int(parents[node]), -1) for node in joints], dtype=np.int64)


def _rotations(world: FloatArray) -> FloatArray:
    """(..., 4) the quaternions of matrices (..., 4, 4), without their scale and shear."""
    x, y = world[..., :3, 0], world[..., :3, 1]
    x = x / np.maximum(np.linalg.norm(x, axis=-1, keepdims=True), MIN_SCALE)
    y = y - np.sum(x * y, axis=-1, keepdims=True) * x
    y = y / np.maximum(np.linalg.norm(y, axis=-1, keepdims=True), MIN_SCALE)
    return matrices_to_quaternions(np.stack([x, y, np.cross(x, y)], axis=-1))
