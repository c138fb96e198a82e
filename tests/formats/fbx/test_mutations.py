"""Damaged FBX files are refused with our own errors, in a short time and little memory."""

from __future__ import annotations

import tracemalloc
from contextlib import suppress

import numpy as np
import pytest

from app.errors import Unreadable
from app.formats.fbx.reader import read_fbx
from app.kinedex_error import KinedexError
from tests.cpu_time import cpu_seconds_below
from tests.formats.fbx.files import AUTO, CUBIC, Bone, Curve, Take, fbx
from tests.formats.fbx.test_reader import CHAIN, SWAY, TRAITS, clip, curves

MAX_SECONDS = 1.0
"""The most CPU time for a file."""
MAX_MEMORY = 60_000_000
"""The most memory for a file in bytes. The damaged files have a few kilobytes."""


def seeds() -> list[bytes]:
    """Small files that together have all properties that the reader supports."""
    rich = [Bone("Scene", -1, {"Lcl Scaling": (2.0, 2.0, 2.0)}, "Null")]
    rich += [
        Bone(b.name, b.parent + 1, {**b.properties, **TRAITS["both"], "InheritType": 2})
        for b in CHAIN
    ]
    smooth = {
        (2, "Lcl Rotation"): {"X": Curve([0, 0.3, 0.5], [0, 9, 5], CUBIC | AUTO)},
        (1, "Lcl Scaling"): {"Y": Curve([0], [1])},
    }
    return [
        clip(),
        clip(version=7500, deflate=False),
        fbx(rich, [Take("a", [smooth], (0, 1)), Take("b", [curves(SWAY)])]),
    ]


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """`content` with some bytes replaced, or with a piece cut, doubled or moved."""
    data = bytearray(content)
    kind = rng.integers(6)
    at = int(rng.integers(20, len(data)))
    length = int(rng.integers(1, 40))
    if kind <= 2:
        for _ in range(int(rng.integers(1, 4))):
            data[int(rng.integers(18, len(data)))] = int(rng.choice([0, 1, 255, rng.integers(256)]))
    elif kind == 3:
        del data[at : at + length]
    elif kind == 4:
        data[at:at] = data[at : at + length]
    else:
        word = int(rng.choice([0, 2**31 - 1, 2**32 - 1, rng.integers(2**32)]))
        data[at : at + 4] = word.to_bytes(4, "little")
    return bytes(data)


def read_mutations(contents: list[bytes], count: int, seed: int) -> int:
    """Read `count` mutations, each within MAX_SECONDS; returns how many could be read."""
    rng = np.random.default_rng(seed)
    read = 0
    for index in range(count):
        content = mutated(contents[index % len(contents)], rng)
        with suppress(KinedexError), cpu_seconds_below(MAX_SECONDS, f"mutation {index}"):
            recording = read_fbx(content)
            assert np.isfinite(recording.positions).all()
            assert recording.rotations is not None
            assert np.isfinite(recording.rotations).all()
            read += 1
    return read


def test_damaged_files_are_refused_or_read() -> None:
    assert 0 < read_mutations(seeds(), 300, seed=0) < 300


def test_damaged_files_need_little_memory() -> None:
    tracemalloc.start()
    read_mutations(seeds(), 60, seed=2)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < MAX_MEMORY


@pytest.mark.slow
def test_ten_thousand_damaged_files_are_refused_or_read() -> None:
    assert 0 < read_mutations(seeds(), 10_000, seed=1) < 10_000


def without_properties(content: bytes, name: str) -> tuple[bytes, int]:
    """The file with a property count of 0 in all records of a name, and their number."""
    result, changed, at = bytearray(content), 0, -1
    length_and_name = bytes([len(name)]) + name.encode()
    while (at := content.find(length_and_name, at + 1)) >= 0:
        # before the name: where the record ends, its property count, the length of these
        assert 0 < int.from_bytes(content[at - 8 : at - 4], "little") < 10
        result[at - 8 : at - 4] = bytes(4)
        changed += 1
    return bytes(result), changed


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("C", "curves that move joints"),
        ("Model", "id, name and type of a Model"),
        ("AnimationCurve", "id, name and type of a AnimationCurve"),
    ],
)
def test_records_without_properties_are_refused(name: str, expected: str) -> None:
    """In an earlier version, a count of 0 caused an error in connections."""
    content, changed = without_properties(clip(), name)
    assert changed > 0
    with pytest.raises(Unreadable, match=expected):
        read_fbx(content)


@pytest.mark.parametrize("name", ["P", "EncryptionType"])
def test_records_that_a_clip_does_not_need_are_ignored(name: str) -> None:
    content, changed = without_properties(clip(), name)
    assert changed > 0
    assert len(read_fbx(content).positions) == len(read_fbx(clip()).positions)
