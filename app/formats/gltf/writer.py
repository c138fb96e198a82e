"""Writes an animation as binary glTF 2.0 (GLB): a node for each joint, and a mesh of sticks.

Meters, Y up, as glTF requires. A GLB file is a JSON object and a block of numbers, so json and
numpy are enough to write it. pygltflib needs eight packages to build the same object, and trimesh
does not write skins or animations. Source: Khronos, "glTF 2.0 specification", sections 3.7 (skins),
3.11 (animations), 4 (GLB).
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.formats.gltf.mesh import Mesh, stick_mesh
from app.motion.skeleton.animation import Animation, continuous
from app.motion.skeleton.kinematics import rest_positions
from app.numerics.arrays import FloatArray

_FLOAT, _USHORT, _UINT = 5126, 5123, 5125
_ARRAY_BUFFER, _INDEX_BUFFER = 34962, 34963
_COLOR = (0.23, 0.42, 0.65, 1.0)
_MIN_CHANGE = 1e-7
"""A joint whose values change by less over the clip is not animated. Meters, or no unit."""
_Json = dict[str, Any]


def write_glb(animation: Animation, name: str = "motion", license: str | None = None) -> bytes:
    """The bytes of a GLB file with the rotations of joints, and with translations that change.

    license: the text of `asset.copyright`.
    """
    blob = _Blob()
    joints = len(animation.skeleton)
    armature, body = joints, joints + 1  # these nodes follow the nodes of the joints
    roots = np.flatnonzero(animation.skeleton.parents < 0).tolist()
    rotations = _xyzw(animation.rotations)
    asset = {"version": "2.0", "generator": "Kinedex"}
    document: _Json = {
        "asset": asset | ({"copyright": license} if license else {}),
        "scene": 0,
        "scenes": [{"nodes": [armature, body]}],
        "nodes": [
            *_joint_nodes(animation, rotations),
            {"name": name, "children": roots},
            {"name": "body", "mesh": 0, "skin": 0},
        ],
        "meshes": [_mesh(blob, stick_mesh(animation.skeleton))],
        "materials": [_material()],
        "skins": [
            {
                "joints": list(range(joints)),
                "skeleton": armature,
                "inverseBindMatrices": blob.add(_inverse_binds(animation), "MAT4"),
            }
        ],
        "animations": _animations(blob, animation, rotations, name),
        "accessors": blob.accessors,
        "bufferViews": blob.views,
        "buffers": [{"byteLength": blob.size}],
    }
    if not document["animations"]:
        del document["animations"]
    return _packed(document, blob)


class _Blob:
    """The block of numbers, with the accessors and views that locate each array in it."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.size = 0
        self.views: list[_Json] = []
        self.accessors: list[_Json] = []

    def add(self, array: NDArray[Any], kind: str, target: int | None = None) -> int:
        """Add an array, one element a row, and return the index of its accessor.

        kind: the type of an element (SCALAR, VEC3, ...). target: the use of the buffer, if any.
        """
        types = {"f": (_FLOAT, "<f4"), "u": (_USHORT, "<u2"), "i": (_UINT, "<u4")}
        component, dtype = types[array.dtype.kind]
        content = np.ascontiguousarray(array, dtype=dtype)
        data = content.tobytes()
        view: _Json = {"buffer": 0, "byteOffset": self.size, "byteLength": len(data)}
        self.views.append(view | ({"target": target} if target else {}))
        accessor: _Json = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(content),
            "type": kind,
        }
        if kind in ("SCALAR", "VEC3"):
            flat = content.reshape(len(content), -1)
            accessor |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self.accessors.append(accessor)
        # Each array starts at a multiple of 4 bytes (section 3.6.2.4).
        self.parts.append(data + b"\0" * (-len(data) % 4))
        self.size += len(self.parts[-1])
        return len(self.accessors) - 1


def _joint_nodes(animation: Animation, rotations: FloatArray) -> list[_Json]:
    """A node for each joint, in the pose of the first frame."""
    nodes: list[_Json] = []
    for joint, name in enumerate(animation.skeleton.names):
        node: _Json = {
            "name": name,
            "translation": _plain(animation.translations[0, joint]),
            "rotation": _plain(rotations[0, joint]),
        }
        children = animation.skeleton.children(joint)
        nodes.append(node | ({"children": children} if children else {}))
    return nodes


def _mesh(blob: _Blob, sticks: Mesh) -> _Json:
    joints = np.zeros((len(sticks.joints), 4), dtype=np.uint16)
    joints[:, 0] = sticks.joints
    weights = np.zeros((len(sticks.joints), 4), dtype=np.float32)
    weights[:, 0] = 1.0
    attributes = {
        "POSITION": blob.add(sticks.corners.astype(np.float32), "VEC3", _ARRAY_BUFFER),
        "JOINTS_0": blob.add(joints, "VEC4", _ARRAY_BUFFER),
        "WEIGHTS_0": blob.add(weights, "VEC4", _ARRAY_BUFFER),
    }
    indices = blob.add(sticks.triangles.reshape(-1, 1).astype(np.int64), "SCALAR", _INDEX_BUFFER)
    return {
        "name": "body",
        "primitives": [{"attributes": attributes, "indices": indices, "material": 0}],
    }


def _material() -> _Json:
    surface = {"baseColorFactor": _COLOR, "metallicFactor": 0.0, "roughnessFactor": 0.8}
    return {"name": "sticks", "pbrMetallicRoughness": surface}


def _inverse_binds(animation: Animation) -> FloatArray:
    """(joints, 16) float32 matrices, column-major: rest pose -> the frame of each joint."""
    rest = rest_positions(animation.skeleton)
    matrices = np.repeat(np.eye(4)[None], len(rest), axis=0)
    # Column-major: index 3 is the last column. At rest, frames are not turned.
    matrices[:, 3, :3] = -rest
    return matrices.reshape(-1, 16).astype(np.float32)


def _animations(blob: _Blob, animation: Animation, rotations: FloatArray, name: str) -> list[_Json]:
    """The animation of all joints that turn or move; an empty list if no joint does."""
    times = np.arange(len(rotations), dtype=np.float64) / animation.frame_rate
    times_at: int | None = None
    samplers: list[_Json] = []
    channels: list[_Json] = []
    fixed = ~animation.moving_joints()
    moves = animation.translations.copy()
    moves[:, fixed] = animation.skeleton.offsets[fixed]
    for path, kind, values in (("rotation", "VEC4", rotations), ("translation", "VEC3", moves)):
        for joint in np.flatnonzero(np.ptp(values, axis=0).max(axis=-1) > _MIN_CHANGE).tolist():
            if times_at is None:
                times_at = blob.add(times[:, None], "SCALAR")
            output = blob.add(values[:, joint], kind)
            channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
            samplers.append({"input": times_at, "interpolation": "LINEAR", "output": output})
    return [{"name": name, "channels": channels, "samplers": samplers}] if channels else []


def _xyzw(rotations: FloatArray) -> FloatArray:
    """(frames, joints, 4) unit quaternions x y z w, the order of glTF, without jumps of sign."""
    turned = continuous(rotations.astype(np.float64))
    turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
    return np.asarray(turned[..., [1, 2, 3, 0]])


def _plain(numbers: FloatArray) -> list[float]:
    return [float(number) for number in numbers]


def _packed(document: _Json, blob: _Blob) -> bytes:
    """The bytes of the file: header, JSON chunk padded with spaces, chunk of numbers."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + blob.size
    head = struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON")
    return b"".join([head, text, struct.pack("<I4s", blob.size, b"BIN\0"), *blob.parts])
