"""Broken FBX files: refused with our own failures, at once, and within a file's memory."""

from __future__ import annotations

import time
import tracemalloc
from contextlib import suppress

import numpy as np
import pytest

from app.errors import KinedexError
from app.formats.fbx import read_fbx
from tests.formats.fbx_files import AUTO, CUBIC, Bone, Curve, Take, fbx
from tests.formats.test_fbx import CHAIN, SWAY, TRAITS, clip, curves

SLOWEST = 1.0
"""Seconds a file."""
MOST_MEMORY = 60_000_000
"""Bytes a file; the mutated ones have a few kilobytes."""


def seeds() -> list[bytes]:
    """Small files that together have every trait."""
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
    """Some bytes replaced, or a piece cut, doubled or moved."""
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


def hold(contents: list[bytes], count: int, seed: int) -> tuple[float, int]:
    """Read `count` mutations; the slowest in seconds, and how many could be read."""
    rng = np.random.default_rng(seed)
    slowest, read = 0.0, 0
    for index in range(count):
        content = mutated(contents[index % len(contents)], rng)
        start = time.perf_counter()
        try:
            recording = read_fbx(content)
        except KinedexError:
            pass
        else:
            read += 1
            assert np.isfinite(recording.positions).all()
            assert recording.rotations is not None
            assert np.isfinite(recording.rotations).all()
        slowest = max(slowest, time.perf_counter() - start)
    return slowest, read


def test_mutations_are_refused_or_read() -> None:
    slowest, read = hold(seeds(), 300, seed=0)
    assert slowest < SLOWEST
    assert 0 < read < 300


def test_mutations_do_not_eat_memory() -> None:
    tracemalloc.start()
    hold(seeds(), 60, seed=2)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < MOST_MEMORY


@pytest.mark.slow
def test_ten_thousand_mutations_are_refused_or_read() -> None:
    slowest, _ = hold(seeds(), 10_000, seed=1)
    assert slowest < SLOWEST


@pytest.mark.parametrize("name", ["C", "P", "Model", "AnimationCurve", "EncryptionType"])
def test_records_that_lost_their_properties(name: str) -> None:
    """A count of 0 once broke connections."""
    content = bytearray(clip())
    at = -1
    while (at := content.find(bytes([len(name)]) + name.encode(), at + 1)) >= 0:
        if content[at - 8 : at - 4] in (b"\3\0\0\0", b"\4\0\0\0", b"\7\0\0\0", b"\1\0\0\0"):
            content[at - 8 : at - 4] = bytes(4)
    with suppress(KinedexError):
        read_fbx(bytes(content))
