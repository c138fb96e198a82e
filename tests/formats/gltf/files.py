"""Reads GLB files in a simple way by the specification, and runs the Khronos validator."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.numerics.arrays import FloatArray

_TYPES = {5126: "<f4", 5123: "<u2", 5125: "<u4"}
_SIZES = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
NPM_SECONDS = 120.0
PACKAGE = "gltf-validator@2.0.0-dev.3.10"
"""The validator has only development versions."""


class Glb:
    """The JSON object of a GLB file, and its arrays."""

    def __init__(self, content: bytes) -> None:
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        size, kind = struct.unpack_from("<I4s", content, 12)
        assert kind == b"JSON"
        self.document: dict[str, Any] = json.loads(content[20 : 20 + size])
        binary_size, kind = struct.unpack_from("<I4s", content, 20 + size)
        assert kind == b"BIN\0"
        self.binary = content[28 + size :]
        assert len(self.binary) == binary_size == self.document["buffers"][0]["byteLength"]

    def array(self, accessor: int) -> FloatArray:
        """(count, numbers of an element) the numbers of an accessor."""
        entry = self.document["accessors"][accessor]
        view = self.document["bufferViews"][entry["bufferView"]]
        part = self.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        numbers = np.frombuffer(part, _TYPES[entry["componentType"]])
        return numbers.reshape(entry["count"], _SIZES[entry["type"]])

    def times(self) -> FloatArray:
        """The times of the keys in seconds. All samplers share them."""
        (animation,) = self.document["animations"]
        (keys,) = {sampler["input"] for sampler in animation["samplers"]}
        return self.array(keys)[:, 0]

    def world(self) -> FloatArray:
        """(frames, nodes, 4, 4) the world matrix of each node at each key."""
        nodes = self.document["nodes"]
        frames = len(self.times()) if "animations" in self.document else 1
        moves = np.zeros((frames, len(nodes), 3))
        turns = np.tile([0.0, 0, 0, 1], (frames, len(nodes), 1))
        for index, node in enumerate(nodes):
            moves[:, index] = node.get("translation", [0, 0, 0])
            turns[:, index] = node.get("rotation", [0, 0, 0, 1])
        for animation in self.document.get("animations", []):
            for channel in animation["channels"]:
                values = self.array(animation["samplers"][channel["sampler"]]["output"])
                target = moves if channel["target"]["path"] == "translation" else turns
                target[:, channel["target"]["node"]] = values
        local = np.zeros((frames, len(nodes), 4, 4))
        matrices = Rotation.from_quat(turns.reshape(-1, 4)).as_matrix()
        local[..., :3, :3] = matrices.reshape(frames, len(nodes), 3, 3)
        local[..., :3, 3] = moves
        local[..., 3, 3] = 1
        return self._gathered(local)

    def _gathered(self, local: FloatArray) -> FloatArray:
        world = np.zeros_like(local)
        waiting = [(root, np.eye(4)) for root in self.document["scenes"][0]["nodes"]]
        while waiting:
            node, above = waiting.pop()
            world[:, node] = above @ local[:, node]
            children = self.document["nodes"][node].get("children", [])
            waiting += [(child, world[:, node]) for child in children]
        return world

    def skinned(self) -> FloatArray:
        """(frames, corners, 3): the mesh as the skin moves it."""
        (primitive,) = self.document["meshes"][0]["primitives"]
        corners = self.array(primitive["attributes"]["POSITION"])
        owners = self.array(primitive["attributes"]["JOINTS_0"])[:, 0]
        skin = self.document["skins"][0]
        binds = self.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        matrices = self.world()[:, skin["joints"]] @ binds
        homogeneous = np.concatenate([corners, np.ones((len(corners), 1))], axis=1)
        return np.einsum("fcij,cj->fci", matrices[:, owners.astype(int)], homogeneous)[..., :3]


_JUDGE = """
const validator = require("gltf-validator"), fs = require("fs");
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])))
  .then(report => console.log(JSON.stringify(report)));
"""


class Validator:
    """Khronos' glTF validator, from npm, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        if shutil.which("node") is None or shutil.which("npm") is None:
            pytest.skip("GLTF VALIDATOR ABSENT: node and npm are not installed")
        (folder / "judge.js").write_text(_JUDGE)
        (folder / "package.json").write_text('{"private": true}')
        try:
            run = subprocess.run(
                ["npm", "install", "--no-audit", "--no-fund", PACKAGE],
                cwd=folder, capture_output=True, text=True, timeout=NPM_SECONDS, check=False,
                env=os.environ | {"npm_config_update_notifier": "false"},
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            pytest.skip("GLTF VALIDATOR ABSENT: npm does not answer")
        if run.returncode:
            pytest.skip(f"GLTF VALIDATOR ABSENT: npm cannot install it: {run.stderr[-200:]}")

    def messages(self, content: bytes) -> list[dict[str, Any]]:
        """All that it finds fault with: errors, warnings, infos and hints."""
        file = self.folder / "some.glb"
        file.write_bytes(content)
        done = subprocess.run(
            ["node", "judge.js", file.name],
            cwd=self.folder, capture_output=True, text=True, timeout=300.0, check=True,
        )  # fmt: skip
        report = json.loads(done.stdout)
        messages: list[dict[str, Any]] = report["issues"]["messages"]
        return messages
