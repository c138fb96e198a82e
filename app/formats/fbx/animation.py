"""Reads the animation stacks (takes) of an FBX file, and the properties that their curves drive.

A stack has layers, and a layer has curve nodes. Each curve node drives a property of a node by up
to three curves. Layers above the first one add to it or replace it. Only the first layer is read;
files in which other layers move the body are refused.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from app.formats.fbx.curves import read_keys, read_times, sample
from app.formats.fbx.objects import FbxObject, unsupported_at
from app.formats.fbx.scene import FbxScene
from app.formats.fbx.transforms import ANIMATED_PROPERTIES, FIXED_PROPERTIES
from app.numerics.arrays import FloatArray, IntArray

_AXES = "XYZ"


@dataclass(frozen=True, slots=True)
class Driver:
    """A curve node, and its curves by axis (0, 1, 2)."""

    node: FbxObject
    curves: dict[int, FbxObject]


@dataclass(frozen=True, slots=True)
class Stack:
    """An animation stack, with the driver of each property of a node.

    base, upper: drivers by the id of the node and the name of the property, in the first layer and
    in the layers above it.
    """

    stack: FbxObject
    base: dict[tuple[int, str], Driver] = field(default_factory=dict)
    upper: dict[tuple[int, str], Driver] = field(default_factory=dict)

    def moving(self) -> set[int]:
        """The ids of the nodes whose transform has curves."""
        keys = (*self.base.items(), *self.upper.items())
        return {
            node for (node, name), driver in keys if name in ANIMATED_PROPERTIES and driver.curves
        }

    def key_times(self, nodes: Iterable[FbxObject]) -> list[IntArray]:
        """The times of keys (keys,), in ticks, of each curve that moves one of the nodes."""
        drivers = (self.base.get((node.id, name)) for node in nodes for name in ANIMATED_PROPERTIES)
        found = [read_times(curve) for one in drivers if one for curve in one.curves.values()]
        return [times for times in found if len(times)]

    def refuse_unsupported(self, nodes: Iterable[FbxObject]) -> None:
        """Raise FormatNotSupported if upper layers or unusual properties move the nodes."""
        ids = {node.id for node in nodes}
        for (node, name), driver in self.base.items():
            if node in ids and name in FIXED_PROPERTIES and driver.curves:
                raise unsupported_at(driver.node.location, f"expected no curves on {name}")
        read = (*ANIMATED_PROPERTIES, *FIXED_PROPERTIES)
        for (node, name), driver in self.upper.items():
            if node in ids and name in read and not _is_neutral(driver):
                message = "expected one animation layer; merge the layers"
                raise unsupported_at(driver.node.location, message)

    def channel(
        self, scene: FbxScene, node: FbxObject, name: str, still: FloatArray, ticks: FloatArray
    ) -> FloatArray:
        """(frames, 3) float32 the values of a property; (1, 3) if they do not change.

        still: (3,) the values without curves. ticks: (frames,). Rotations are in degrees. Raises
        the errors of `sample`.
        """
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
    """All stacks, in the order of the file."""
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
    """Whether all curves of an upper layer are zero. Programs write layers without edits so."""
    return not any(np.any(read_keys(curve).values) for curve in driver.curves.values())
