"""Finds the nodes of an FBX scene that are joints of the body.

Limb nodes are joints. Nodes between them are joints too, and so is a node above them that moves
(a reference node that carries the hips). In a scene without limb nodes, the Nulls that move are
joints. If there are several bodies, the one with the most moving joints is read.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.limits import MAX_JOINTS
from app.formats.fbx.objects import FbxObject
from app.formats.fbx.scene import FbxScene
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import BoolArray, IntArray

LIMB_TYPES = frozenset(("LimbNode", "Limb", "Root"))
"""The subtypes of limb nodes."""


@dataclass(frozen=True, slots=True)
class Body:
    """The joints of a body and all nodes above them.

    nodes: (nodes,) parents come before their children. parents: (nodes,) -1 for none. is_joint:
    (nodes,) False for nodes above the body, which only carry it.
    """

    nodes: tuple[FbxObject, ...]
    parents: IntArray
    is_joint: BoolArray
    cautions: tuple[Caution, ...]


def find_body(scene: FbxScene, moving: Collection[int]) -> Body:
    """Find the body in a scene.

    moving: the ids of the nodes that have curves. Raises Unreadable if there is no body or if no
    body moves, and TooLarge for more than MAX_JOINTS joints.
    """
    nodes, parents = _in_order(scene)
    moves = [node.id in moving for node in nodes]
    roots = _roots(parents, _joints(parents, _limbs(scene, nodes, moves), moves))
    root, others = _chosen(roots, moves)
    names = [nodes[other].name for other in others]
    return _body(nodes, parents, [found == root for found in roots], names)


def _limbs(scene: FbxScene, nodes: list[FbxObject], moves: list[bool]) -> list[bool]:
    """Whether each node is a limb node or, in a scene without limb nodes, a Null that moves."""
    limbs = [_is_limb(scene, node) for node in nodes]
    if any(limbs):
        return limbs
    return [node.subtype == "Null" and move for node, move in zip(nodes, moves, strict=True)]


def _chosen(roots: list[int], moves: list[bool]) -> tuple[int, list[int]]:
    """The root of the body with the most moving joints, and the roots of other moving bodies.

    roots: the root of each node's body, -1 for none. Raises Unreadable.
    """
    bodies = Counter(root for root in roots if root >= 0)
    if not bodies:
        raise unreadable_at("node Objects/Model", "expected a skeleton of limb nodes, found none")
    moved = Counter(root for root, move in zip(roots, moves, strict=True) if move and root >= 0)
    if not moved:
        raise unreadable_at("node Objects/AnimationCurve", "expected curves that move joints")
    # If numbers are equal, the larger body is read, and then the first one in the file.
    chosen = max(bodies, key=lambda one: (moved[one], bodies[one], -one))
    return chosen, [one for one in moved if one != chosen and bodies[one] > 1]


def _in_order(scene: FbxScene) -> tuple[list[FbxObject], list[int]]:
    """The nodes of a scene, each after its parent, and the index of each parent (-1 for none).

    Raises Unreadable if nodes are their own ancestors.
    """
    children: dict[int, list[FbxObject]] = {}
    models = scene.of_kind("Model")
    waiting: list[tuple[FbxObject, int]] = []
    for model in models:
        parent = next(scene.targets(model, "Model"), None)
        if parent is None:
            waiting.append((model, -1))
        else:
            children.setdefault(parent.id, []).append(model)
    # A stack takes the last one first, so reversed lists keep the order of the file.
    waiting.reverse()
    nodes: list[FbxObject] = []
    parents: list[int] = []
    while waiting:
        node, parent_index = waiting.pop()
        waiting += [(child, len(nodes)) for child in reversed(children.get(node.id, []))]
        nodes.append(node)
        parents.append(parent_index)
    if len(nodes) < len(models):
        reached = {node.id for node in nodes}
        lost = next(model for model in models if model.id not in reached)
        raise lost.unreadable("expected a node that is not its own ancestor")
    return nodes, parents


def _is_limb(scene: FbxScene, node: FbxObject) -> bool:
    if node.subtype in LIMB_TYPES:
        return True
    return any(one.subtype in LIMB_TYPES for one, _ in scene.sources(node, "NodeAttribute"))


def _joints(parents: list[int], limbs: list[bool], moves: list[bool]) -> list[bool]:
    """Whether each node is a joint: a limb, or a node that moves or is between limbs."""
    # below: the node has a limb below it. above: the node has a limb above it.
    below, above = [False] * len(parents), [False] * len(parents)
    for index in reversed(range(len(parents))):
        if parents[index] >= 0:
            below[parents[index]] |= limbs[index] or below[index]
    for index, parent in enumerate(parents):
        above[index] = parent >= 0 and (limbs[parent] or above[parent])
    return [
        limb or (low and (move or high))
        for limb, low, move, high in zip(limbs, below, moves, above, strict=True)
    ]


def _roots(parents: list[int], joints: list[bool]) -> list[int]:
    """The highest joint above each joint, or the joint itself; -1 for other nodes."""
    roots: list[int] = []
    for index, parent in enumerate(parents):
        higher = roots[parent] if parent >= 0 else -1
        roots.append((higher if higher >= 0 else index) if joints[index] else -1)
    return roots


def _body(
    nodes: list[FbxObject], parents: list[int], is_joint: list[bool], others: list[str]
) -> Body:
    """The joints with all nodes above them; others: the names of the bodies that are not read."""
    is_used = list(is_joint)
    for index in reversed(range(len(nodes))):
        if is_used[index] and parents[index] >= 0:
            is_used[parents[index]] = True
    indices = [index for index, used in enumerate(is_used) if used]
    if len(indices) > MAX_JOINTS:
        raise too_large("joints", f"expected at most {MAX_JOINTS}")
    new = {old: index for index, old in enumerate(indices)}
    return Body(
        nodes=tuple(nodes[index] for index in indices),
        parents=np.array([new.get(parents[index], -1) for index in indices], dtype=np.int64),
        is_joint=np.array([is_joint[index] for index in indices]),
        cautions=_cautions([nodes[i].name for i in indices if is_joint[i]], others),
    )


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
