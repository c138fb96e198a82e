"""The animation stacks (takes) of an FBX file, and what their curves drive.

A stack has layers, a layer has curve nodes, each of which drives a property of a node by
up to three curves. Layers above the first add to it or replace it; we read one layer.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from app.errors import BadField, Place
from app.formats.fbx.curves import read_keys, read_times, sample
from app.formats.fbx.scene import FbxObject, FbxScene, refused_at
from app.formats.fbx.transforms import ANIMATED, FIXED
from app.numerics.arrays import FloatArray, IntArray

NAMES_SHOWN = 100
_AXES = "XYZ"


@dataclass(frozen=True, slots=True)
class Driver:
    """A curve node and its curves by axis."""

    node: FbxObject
    curves: dict[int, FbxObject]


@dataclass(frozen=True, slots=True)
class Stack:
    """What drives each property (node's id, property's name): `base` in the first layer,
    `upper` in those above it."""

    stack: FbxObject
    base: dict[tuple[int, str], Driver] = field(default_factory=dict)
    upper: dict[tuple[int, str], Driver] = field(default_factory=dict)

    def moving(self) -> set[int]:
        """Ids of the nodes whose transform has curves."""
        keys = (*self.base.items(), *self.upper.items())
        return {node for (node, name), driver in keys if name in ANIMATED and driver.curves}

    def key_times(self, nodes: Iterable[FbxObject]) -> list[IntArray]:
        """The times (keys,) in ticks of each curve that moves one of these nodes."""
        drivers = (self.base.get((node.id, name)) for node in nodes for name in ANIMATED)
        found = [read_times(curve) for one in drivers if one for curve in one.curves.values()]
        return [times for times in found if len(times)]

    def refuse_unknown(self, nodes: Iterable[FbxObject]) -> None:
        """Raise FormatNotSupported if layers or unusual properties move these nodes."""
        ids = {node.id for node in nodes}
        for (node, name), driver in self.base.items():
            if node in ids and name in FIXED and driver.curves:
                raise refused_at(driver.node.place, f"expected no curves on {name}")
        for (node, name), driver in self.upper.items():
            if node in ids and name in (*ANIMATED, *FIXED) and not _is_neutral(driver):
                raise refused_at(
                    driver.node.place, "expected one animation layer; merge the layers"
                )

    def channel(
        self, scene: FbxScene, node: FbxObject, name: str, still: FloatArray, ticks: FloatArray
    ) -> FloatArray:
        """(frames, 3) float32 the values at `ticks` (frames,); (1, 3) if they do not change."""
        driver = self.base.get((node.id, name))
        if driver is None:
            return still[None].astype(np.float32)
        columns: list[FloatArray] = []
        for axis, letter in enumerate(_AXES):
            curve = driver.curves.get(axis)
            values = sample(curve, ticks) if curve is not None else None
            if values is None:
                default = scene.number(driver.node, f"d|{letter}", float(still[axis]))
                values = np.array([default])
            columns.append(values.astype(np.float32))
        if all(np.all(values == values[0]) for values in columns):
            return np.array([[values[0] for values in columns]])
        return np.stack(np.broadcast_arrays(*columns), axis=-1)


def find_stacks(scene: FbxScene) -> list[Stack]:
    """Every stack, in file order."""
    return [_read_stack(scene, stack) for stack in scene.of_kind("AnimationStack")]


def _read_stack(scene: FbxScene, stack: FbxObject) -> Stack:
    found = Stack(stack)
    layers = [layer for layer, _ in scene.sources(stack, "AnimationLayer")]
    for index, layer in enumerate(layers):
        if scene.number(layer, "Mute", 0.0):
            continue
        drivers = found.upper if index else found.base
        for curve_node, _ in scene.sources(layer, "AnimationCurveNode"):
            for target, name in scene.driven(curve_node):
                drivers[target.id, name] = Driver(curve_node, _curves(scene, curve_node))
    return found


def _curves(scene: FbxScene, curve_node: FbxObject) -> dict[int, FbxObject]:
    found: dict[int, FbxObject] = {}
    for curve, name in scene.sources(curve_node, "AnimationCurve"):
        axis = name.removeprefix("d|")
        if len(axis) == 1 and axis in _AXES:
            found[_AXES.index(axis)] = curve
    return found


def _is_neutral(driver: Driver) -> bool:
    """Whether all curves of an upper layer are zero, as in a layer without edits."""
    return not any(np.any(read_keys(curve).values) for curve in driver.curves.values())


def choose_stack(stacks: list[Stack], lengths: list[float], name: str | None) -> int:
    """The index of the stack of this name, else of the longest one; lengths (stacks,).

    Raises BadField for a name that no stack has.
    """
    if name is None:
        return int(np.argmax(lengths))
    names = [one.stack.name for one in stacks]
    tidy = [_as_sent(one) for one in names]
    if _as_sent(name) not in tidy:
        message = f"expected one of the file's stacks ({listed(names)}), found {name!r}"
        raise BadField(f"stack: {message}", places=[Place("stack", message)])
    return tidy.index(_as_sent(name))


def listed(names: list[str]) -> str:
    """The names of the stacks, for a message to people."""
    more = f" and {len(names) - NAMES_SHOWN} more" if len(names) > NAMES_SHOWN else ""
    return ", ".join(names[:NAMES_SHOWN]) + more


def _as_sent(name: str) -> str:
    """A name as a form sends it: composed (NFC), without surrounding space."""
    return unicodedata.normalize("NFC", name).strip()
