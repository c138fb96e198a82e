"""Acclaim skeleton files (ASF): the bones that an AMC file moves.

Bytes in, AcclaimSkeleton out. A bone starts where its parent ends. So the joint with the name of a
bone is at the start of the bone, and a bone without children ends in an end site. Directions are
in the axes of the world, so that every joint has the identity as its rotation if all channels are
zero. Sources: M. Schafer, "Acclaim skeleton file definition v1.10" (1994); "Acclaim format: ASF
line details" (Oxford Metrics, on the web site of CMU); CMU's FAQ for the unit.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.formats.acclaim.lines import lines_of_words
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.limits import MAX_JOINTS
from app.formats.common.lines import with_plain_newlines
from app.formats.common.names import readable_name
from app.formats.common.numbers import excerpt, parse_numbers
from app.motion.skeleton.recording import Caution
from app.motion.skeleton.rotations import euler_to_quaternions, identity_quaternions
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

MAX_ASF_BYTES = 2_000_000
"""The size of the largest skeleton file."""
CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz", "l")
METERS_PER_INCH = 0.0254
STATURES = (0.3, 3.0)
"""Meters: the smallest and the largest rest pose. Outside, `length` does not give the unit."""


@dataclass(frozen=True, slots=True)
class AcclaimSkeleton:
    """A skeleton, and how the channels of an AMC file move it. Joint 0 is the root.

    channels: for each joint, names from CHANNELS in the order of the numbers in the AMC file.
    axes: (joints, 4) quaternions C, which turn the world's axes to those of each bone; the
    identity for the root. orientation: (4,) the turn of the root before it moves. directions:
    (joints, 3) unit vectors along the bones in the axes of the world, zero for the root.
    in_degrees: whether angles are in degrees, else in radians. metres_per_unit: None if `length`
    does not give the unit.
    """

    skeleton: Skeleton
    channels: tuple[tuple[str, ...], ...]
    axes: FloatArray
    orientation: FloatArray
    directions: FloatArray
    in_degrees: bool
    metres_per_unit: float | None
    cautions: tuple[Caution, ...]


def read_asf(content: bytes) -> AcclaimSkeleton:
    """Read an ASF file. Raises Unreadable with the line, and TooLarge."""
    if len(content) > MAX_ASF_BYTES:
        raise too_large("skeleton", f"expected at most {MAX_ASF_BYTES} bytes")
    return _Reader(with_plain_newlines(content)).read()


@dataclass(slots=True)
class _Bone:
    """A bone of `:bonedata`, or the root. `order` names the axis that turns first, first."""

    line: int
    name: bytes = b""
    direction: FloatArray = field(default_factory=lambda: np.zeros(3))
    length: float = 0.0
    angles: FloatArray = field(default_factory=lambda: np.zeros(3))
    order: str = "XYZ"
    channels: tuple[str, ...] = ()


class _Reader:
    """Reads the lines in order. `section` is the last keyword with a colon."""

    def __init__(self, text: bytes) -> None:
        self.lines = lines_of_words(text.translate(_AS_SPACES))
        self.line = 1
        self.section = ""
        self.root = _Bone(1, _ROOT)
        self.position: FloatArray = np.zeros(3)
        self.bones: dict[bytes, _Bone] = {}
        self.parents: dict[bytes, bytes] = {}
        self.length_unit = 1.0
        self.in_degrees = True

    def read(self) -> AcclaimSkeleton:
        for line, words in self.lines:
            self.line = line
            keyword = words[0].lower().decode("ascii", "replace")
            if keyword.startswith(":"):
                self.section = keyword[1:]
            elif self.section == "units":
                self._unit(keyword, words)
            elif self.section == "root":
                self._root(keyword, words)
            elif self.section == "bonedata" and keyword == "begin":
                self._bone()
            elif self.section == "hierarchy" and keyword not in ("begin", "end"):
                self._children(words)
        if not self.bones:
            raise unreadable_line(self.line, "expected bones under :bonedata, found none")
        return self._skeleton()

    def _unit(self, keyword: str, words: list[bytes]) -> None:
        if keyword == "length":
            self.length_unit = float(self._numbers(words, 1)[0])
        elif keyword == "angle":
            self.in_degrees = self._is_degrees(words)

    def _is_degrees(self, words: list[bytes]) -> bool:
        name = words[1].lower() if len(words) > 1 else b""
        if not name.startswith((b"deg", b"rad")):
            raise unreadable_line(self.line, f"expected deg or rad, found {excerpt(name)}")
        return name.startswith(b"deg")

    def _root(self, keyword: str, words: list[bytes]) -> None:
        if keyword == "order":
            self.root.channels = self._channels(words)
        elif keyword == "axis":
            self.root.order = self._order(words[1:])
        elif keyword == "position":
            self.position = self._numbers(words, 3)
        elif keyword == "orientation":
            self.root.angles = self._numbers(words, 3)

    def _bone(self) -> None:
        """Read up to `end` of the bone. Other lines, such as limits and masses, are ignored."""
        bone = _Bone(self.line)
        for line, words in self.lines:
            self.line = line
            keyword = words[0].lower()
            if keyword == b"end":
                return self._add(bone)
            if keyword.startswith(b":") or keyword == b"begin":
                break
            self._bone_line(bone, keyword, words)
        raise unreadable_line(self.line, f"expected the end of bone {excerpt(bone.name)}")

    def _bone_line(self, bone: _Bone, keyword: bytes, words: list[bytes]) -> None:
        if keyword == b"name":
            bone.name = b" ".join(words[1:])
        elif keyword == b"direction":
            bone.direction = _unit_vector(self._numbers(words, 3))
        elif keyword == b"length":
            bone.length = float(self._numbers(words, 1)[0])
        elif keyword == b"axis":
            bone.angles = self._numbers(words[:4], 3)
            bone.order = self._order(words[4:])
        elif keyword == b"dof":
            bone.channels = self._channels(words)

    def _add(self, bone: _Bone) -> None:
        readable_name(bone.name, bone.line)
        key = bone.name.lower()
        if key in self.bones or key == _ROOT:
            raise unreadable_line(bone.line, f"expected each bone once, found {excerpt(bone.name)}")
        if len(self.bones) >= MAX_JOINTS:
            raise too_large(f"line {bone.line}", f"expected at most {MAX_JOINTS} bones")
        self.bones[key] = bone

    def _children(self, words: list[bytes]) -> None:
        parent, *children = (word.lower() for word in words)
        for name in (parent, *children):
            if name not in self.bones and name != _ROOT:
                raise unreadable_line(self.line, f"expected a bone's name, found {excerpt(name)}")
        for child in children:
            if child == _ROOT or self.parents.setdefault(child, parent) != parent:
                raise unreadable_line(self.line, f"expected one parent for {excerpt(child)}")

    def _numbers(self, words: list[bytes], count: int) -> FloatArray:
        numbers = parse_numbers(b" ".join(words[1:]), self.line)
        if len(numbers) != count:
            message = f"expected {count} numbers after {excerpt(words[0])}, found {len(numbers)}"
            raise unreadable_line(self.line, message)
        return numbers

    def _order(self, words: list[bytes]) -> str:
        order = b"".join(words).decode("ascii", "replace").upper() or "XYZ"
        if sorted(order) != ["X", "Y", "Z"]:
            raise unreadable_line(
                self.line, f"expected an order of axes such as XYZ, found {order!r}"
            )
        return order

    def _channels(self, words: list[bytes]) -> tuple[str, ...]:
        channels = tuple(word.decode("ascii", "replace").lower() for word in words[1:])
        if len(set(channels)) != len(channels) or not set(channels) <= set(CHANNELS):
            listed = " ".join(CHANNELS)
            raise unreadable_line(self.line, f"expected each of {listed} at most once")
        return channels

    def _skeleton(self) -> AcclaimSkeleton:
        order = self._tree_order()
        if not self.root.channels:
            raise unreadable_line(
                self.line, "expected an order of channels under :root, found none"
            )
        bones = [self.root, *(self.bones[name] for name in order[1:])]
        index = {name: joint for joint, name in enumerate(order)}
        parents = np.array([-1, *(index[self.parents[name]] for name in order[1:])])
        # vectors (joints, 3): from the start to the end of each bone
        vectors = np.array([bone.length * bone.direction for bone in bones])
        offsets = np.concatenate([self.position[None], vectors[parents[1:]]])
        leaves = np.setdiff1d(np.arange(len(bones)), parents)
        skeleton = Skeleton(
            tuple(readable_name(bone.name, bone.line) for bone in bones),
            parents,
            offsets,
            leaves,
            vectors[leaves],
        )
        return AcclaimSkeleton(
            skeleton,
            channels=tuple(bone.channels for bone in bones),
            axes=np.array([identity_quaternions(()), *map(self._axes, bones[1:])]),
            orientation=self._axes(self.root),
            directions=np.array([bone.direction for bone in bones]),
            in_degrees=self.in_degrees,
            metres_per_unit=_metres_per_unit(self.length_unit, skeleton),
            cautions=self._cautions(),
        )

    def _tree_order(self) -> list[bytes]:
        """Names of bones, each after its parent, depth first in the order of the file.

        There is no recursion, so that any depth can be read. Raises Unreadable for a bone that is
        not below the root, which also covers circles.
        """
        children: dict[bytes, list[bytes]] = {}
        for child, parent in self.parents.items():
            children.setdefault(parent, []).append(child)
        order, waiting = [], [_ROOT]
        while waiting:
            order.append(waiting.pop())
            waiting += reversed(children.get(order[-1], ()))
        reached = set(order)
        unreached = next((bone for name, bone in self.bones.items() if name not in reached), None)
        if unreached is not None:
            message = f"expected bone {excerpt(unreached.name)} in :hierarchy, below the root"
            raise unreadable_line(unreached.line, message)
        return order

    def _axes(self, bone: _Bone) -> FloatArray:
        """(4,) the quaternion C: the product of turns about fixed axes, in the given order."""
        angles = np.radians(bone.angles) if self.in_degrees else bone.angles
        by_axis = dict(zip("XYZ", angles, strict=True))
        outermost_first = bone.order[::-1]
        turned = np.array([by_axis[axis] for axis in outermost_first])
        return euler_to_quaternions(turned, outermost_first)

    def _cautions(self) -> tuple[Caution, ...]:
        if not self.root.angles.any():
            return ()
        detail = "the root has an orientation before it moves, which programs read differently"
        return (Caution("root_orientation", detail, joint="root"),)


_ROOT = b"root"
_AS_SPACES = bytes.maketrans(b"(),", b"   ")


def _unit_vector(vector: FloatArray) -> FloatArray:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector


def _metres_per_unit(length: float, skeleton: Skeleton) -> float | None:
    """The meters per unit if `length` is units per inch.

    None if `length` is 1, which programs write that do not know the unit, or if the rest pose then
    has an impossible stature.
    """
    if length <= 0 or length == 1.0:
        return None
    scale = METERS_PER_INCH / length
    stature = scale * float(np.ptp(_rest_positions(skeleton), axis=0).max())
    return scale if STATURES[0] <= stature <= STATURES[1] else None


def _rest_positions(skeleton: Skeleton) -> FloatArray:
    """(joints + ends, 3) positions with all channels zero."""
    positions = np.array(skeleton.offsets)
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            positions[joint] += positions[parent]
    ends = positions[skeleton.end_parents] + skeleton.end_offsets
    return np.concatenate([positions, ends])
