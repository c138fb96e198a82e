"""Finds the nodes of a glTF file that are joints of a body, and their tree.

The joints of a skin are joints, and so are the nodes between them. A VRM file names the human
bones. Without a skin and without human bones, the nodes that move and empty nodes below them are
joints. Nodes above the joints only carry them. Joints of one skin are of one body, also if they
have several roots.

Sources: Khronos, "glTF 2.0 specification", sections 3.5 (nodes) and 3.7.3 (skins); VRM Consortium,
"VRM 0.0", "VRMC_vrm-1.0" and "VRMC_vrm_animation-1.0".
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.limits import MAX_JOINTS
from app.formats.common.names import MAX_NAME_LENGTH
from app.formats.gltf.container import Container, Json
from app.motion.skeleton.recording import Caution
from app.motion.skeleton.rotations import matrices_to_quaternions
from app.numerics.arrays import BoolArray, FloatArray, IntArray

MAX_NODES = 200_000
_SHOWN = ("mesh", "camera", "extensions")
"""Members of nodes that are objects and not joints."""
_VRM = ("VRM", "VRMC_vrm", "VRMC_vrm_animation")


@dataclass(frozen=True, slots=True)
class Body:
    """The joints of a body and all nodes above them.

    nodes: (nodes,) the index of each in the file; parents come before their children. names:
    (nodes,). parents: (nodes,) -1 for none. is_joint: (nodes,) False for nodes above the joints.
    """

    nodes: IntArray
    names: tuple[str, ...]
    parents: IntArray
    is_joint: BoolArray
    cautions: tuple[Caution, ...]


def find_body(container: Container, moving: Collection[int]) -> Body:
    """Find the body in a file.

    moving: the nodes that have an animation. Raises Unreadable if there are no joints, or if nodes
    are their own ancestors, and TooLarge.
    """
    nodes = container.entries("nodes")
    if len(nodes) > MAX_NODES:
        raise too_large("nodes", f"expected at most {MAX_NODES}")
    order, parents = _in_order(nodes)
    skins = _skins(container, len(nodes))
    human = dict(_human_bones(container, len(nodes)))
    chosen = set().union(*skins, human) or _carried(nodes, order, parents, moving)
    joints = _with_nodes_between(order, parents, chosen)
    tops = _tops(order, parents, joints)
    own, others = _chosen_body(tops, _groups(tops, skins), moving)
    if len(own) > MAX_JOINTS:
        raise too_large("joints", f"expected at most {MAX_JOINTS}, found {len(own)}")
    return _body(nodes, human, order, parents, own, others)


def _in_order(nodes: list[Json]) -> tuple[list[int], list[int]]:
    """The nodes, each after its parent, and (nodes,) the parent of each node, -1 for none."""
    parents = [-1] * len(nodes)
    for index, node in enumerate(nodes):
        for child in _children(node, index, len(nodes)):
            if parents[child] >= 0:
                raise unreadable_at(f"nodes/{child}", "expected one parent, found two")
            parents[child] = index
    order = []
    waiting = [index for index in reversed(range(len(nodes))) if parents[index] < 0]
    while waiting:
        index = waiting.pop()
        order.append(index)
        waiting += reversed(_children(nodes[index], index, len(nodes)))
    if len(order) < len(nodes):
        raise unreadable_at("nodes", "expected trees, found a node that is its own ancestor")
    return order, parents


def _children(node: Json, index: int, count: int) -> list[int]:
    return _indices(node.get("children", []), f"nodes/{index}/children", count)


def _indices(found: object, location: str, count: int) -> list[int]:
    """A list of indices below `count`. Raises Unreadable."""
    good = isinstance(found, list) and all(type(one) is int and 0 <= one < count for one in found)
    if not isinstance(found, list) or not good:
        raise unreadable_at(location, f"expected indices below {count}")
    return found


def _skins(container: Container, count: int) -> list[list[int]]:
    """The joints of each skin."""
    return [
        _indices(skin.get("joints", []), f"skins/{index}/joints", count)
        for index, skin in enumerate(container.entries("skins"))
    ]


def _carried(
    nodes: list[Json], order: list[int], parents: list[int], moving: Collection[int]
) -> set[int]:
    """The nodes that move, and those below them that show nothing, which are ends of limbs."""
    found = set(moving)
    for node in order:
        if parents[node] in found and not any(name in nodes[node] for name in _SHOWN):
            found.add(node)
    return {node for node in found if node < len(nodes)}


def _human_bones(container: Container, count: int) -> Iterator[tuple[int, str]]:
    """The node and the name of each human bone of a VRM file."""
    extensions = container.document.get("extensions")
    for name in _VRM:
        extension = extensions.get(name) if isinstance(extensions, dict) else None
        humanoid = extension.get("humanoid") if isinstance(extension, dict) else None
        bones = humanoid.get("humanBones") if isinstance(humanoid, dict) else None
        # VRM 0 has a list of objects with `bone` and `node`; VRM 1 has an object by bone.
        pairs = bones.items() if isinstance(bones, dict) else _listed(bones)
        for bone, entry in pairs:
            node = entry.get("node") if isinstance(entry, dict) else None
            if type(node) is int and 0 <= node < count and isinstance(bone, str):
                yield node, bone


def _listed(bones: object) -> list[tuple[object, Json]]:
    entries = bones if isinstance(bones, list) else []
    return [(entry.get("bone"), entry) for entry in entries if isinstance(entry, dict)]


def _with_nodes_between(order: list[int], parents: list[int], chosen: set[int]) -> list[bool]:
    """(nodes,) whether each node is a joint: chosen, or with a chosen node above and below it."""
    below, above = [False] * len(parents), [False] * len(parents)
    for node in reversed(order):
        if parents[node] >= 0:
            below[parents[node]] |= below[node] or node in chosen
    for node in order:
        parent = parents[node]
        above[node] = parent >= 0 and (parent in chosen or above[parent])
    return [n in chosen or (below[n] and above[n]) for n in range(len(parents))]


def _tops(order: list[int], parents: list[int], joints: list[bool]) -> dict[int, int]:
    """The highest joint above each joint, or the joint itself. Raises Unreadable without joints."""
    tops: dict[int, int] = {}
    for node in order:
        if joints[node]:
            tops[node] = tops.get(parents[node], node)
    if not tops:
        raise unreadable_at("skins", "expected a skeleton (a skin or nodes that move), found none")
    return tops


def _groups(tops: dict[int, int], skins: list[list[int]]) -> dict[int, int]:
    """The body of each top: the first of the tops that share a skin, also by way of others."""
    first = {top: top for top in tops.values()}

    def found(top: int) -> int:
        while first[top] != top:
            first[top] = first[first[top]]  # the way is halved, so long ones stay short
            top = first[top]
        return top

    for skin in skins:
        for joint in skin[1:]:
            first[found(tops[joint])] = found(tops[skin[0]])
    return {top: found(top) for top in first}


def _chosen_body(
    tops: dict[int, int], groups: dict[int, int], moving: Collection[int]
) -> tuple[set[int], list[int]]:
    """The joints of the body with the most moving joints, and the tops of the other bodies."""
    bodies = {node: groups[top] for node, top in tops.items()}
    sizes = Counter(bodies.values())
    moved = Counter(body for node, body in bodies.items() if node in moving)
    chosen = max(sizes, key=lambda body: (moved[body], sizes[body], -body))
    own = {node for node, body in bodies.items() if body == chosen}
    return own, [body for body in sizes if body != chosen and moved[body] > 1]


def _body(
    nodes: list[Json],
    human: dict[int, str],
    order: list[int],
    parents: list[int],
    own: set[int],
    others: list[int],
) -> Body:
    """The joints with all nodes above them; others: the tops of the bodies that are not read."""
    needed = set(own)
    for node in reversed(order):
        if node in needed and parents[node] >= 0:
            needed.add(parents[node])
    used = [node for node in order if node in needed]
    new = {node: index for index, node in enumerate(used)}
    names = tuple(human.get(node) or _name(nodes[node], node) for node in used)
    joint_names = [name for node, name in zip(used, names, strict=True) if node in own]
    return Body(
        nodes=np.array(used, dtype=np.int64),
        names=names,
        parents=np.array([new.get(parents[node], -1) for node in used], dtype=np.int64),
        is_joint=np.array([node in own for node in used]),
        cautions=_cautions(joint_names, [_name(nodes[node], node) for node in others]),
    )


def _name(node: Json, index: int) -> str:
    name = node.get("name")
    text = name[:MAX_NAME_LENGTH] if isinstance(name, str) else ""
    return "".join(char if char.isprintable() else "�" for char in text) or f"node {index}"


def _cautions(names: list[str], others: list[str]) -> tuple[Caution, ...]:
    cautions = []
    if others:
        shown = ", ".join(others[:5])
        detail = f"the file has {len(others) + 1} skeletons; {names[0]} was read, not {shown}"
        cautions.append(Caution("skeleton_chosen", detail, joint=names[0]))
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        detail = f"several joints have the same name: {', '.join(twice[:5])}"
        cautions.append(Caution("duplicate_names", detail, joint=twice[0]))
    return tuple(cautions)


def still_transform(node: Json, index: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The translation (3,), rotation x y z w (4,) and scale (3,) of a node without animation.

    Raises Unreadable.
    """
    if "matrix" in node:
        return _decomposed(_numbers(node, "matrix", index, np.eye(4).ravel()).reshape(4, 4).T)
    return (
        _numbers(node, "translation", index, np.zeros(3)),
        _numbers(node, "rotation", index, np.array([0.0, 0.0, 0.0, 1.0])),
        _numbers(node, "scale", index, np.ones(3)),
    )


def _numbers(node: Json, name: str, index: int, default: FloatArray) -> FloatArray:
    found = node.get(name)
    if found is None:
        return default
    good = isinstance(found, list) and all(type(one) in (int, float) for one in found)
    if not good or len(found) != len(default) or not all(abs(one) <= 1e9 for one in found):
        raise unreadable_at(f"nodes/{index}/{name}", f"expected {len(default)} numbers")
    return np.array(found, dtype=np.float64)


def _decomposed(matrix: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The translation, rotation x y z w and scale of a matrix (4, 4) without shear."""
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if np.linalg.det(matrix[:3, :3]) < 0:
        scale = scale * [-1, 1, 1]
    turned = matrix[:3, :3] / np.where(scale == 0, 1.0, scale)
    return matrix[:3, 3], matrices_to_quaternions(turned)[[1, 2, 3, 0]], scale
