"""Damages files at random, by bytes and by lines. The same seed gives the same damage."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

import numpy as np

from app.kinedex_error import KinedexError
from app.motion.skeleton.recording import Recording
from tests.cpu_time import cpu_seconds_below

MAX_SECONDS = 1.0
"""The most CPU time for a damaged file."""
PIECES = (b"", b"\n", b" ", b"nan", b"1e999", b"-", b"0", b"9", b"\x00", b"\xff", b"\x7f", b"#")


def mutated(content: bytes, seed: int, pieces: Sequence[bytes] = PIECES) -> bytes:
    """`content` with one to four changes: bytes are replaced, cut or doubled, or lines moved."""
    rng = random.Random(seed)
    result = bytearray(content)
    for _ in range(rng.randint(1, 4)):
        start, length = rng.randrange(len(result) + 1), rng.choice((0, 1, 1, 4, 12))
        way = rng.randrange(5)
        if way == 0:
            result[start : start + length] = rng.choice(pieces)
        elif way == 1:
            result[start : start + 1] = rng.randbytes(rng.choice((1, 1, 2, 4)))
        elif way == 2 and rng.random() < 0.2:
            del result[start:]
        elif way == 3:
            result[start:start] = result[start : start + length]
        else:
            _move_lines(result, rng)
    return bytes(result)


def _move_lines(content: bytearray, rng: random.Random) -> None:
    lines = bytes(content).split(b"\n")
    start, source = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[start : start + rng.randrange(3)] = [lines[source]]
    content[:] = b"\n".join(lines)


def check_broken(read: Callable[[int], Recording], seeds: range) -> int:
    """The number of damaged files that are read without an error.

    Raises if a file gives an error that is not ours, takes too long, or gives positions that are
    not finite.
    """
    good = 0
    for seed in seeds:
        try:
            with cpu_seconds_below(MAX_SECONDS, f"seed {seed}"):
                recording = read(seed)
        except KinedexError:
            continue
        assert np.isfinite(recording.positions).all(), f"seed {seed}"
        good += 1
    return good
