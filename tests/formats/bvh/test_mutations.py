"""Damaged BVH files are read, or refused with our own errors, in a short time."""

from __future__ import annotations

import pytest

from app.demo import demo_clips
from app.formats.bvh.reader import read_bvh
from app.motion.skeleton.recording import Recording
from tests.formats import mutations
from tests.formats.samples import bvh
from tests.real_clips import real_clips

PIECES = (*mutations.PIECES, b"{", b"}", b"MOTION\n", b"End Site", b"CHANNELS 3 ", b"Frames: 9\n")


def read_broken(content: bytes, seed: int) -> Recording:
    return read_bvh(mutations.mutated(content, seed, PIECES))


def test_a_damaged_small_file() -> None:
    good = mutations.check_broken(lambda seed: read_broken(bvh(), seed), range(1000))
    assert 10 < good < 990


@pytest.mark.slow
def test_ten_thousand_damaged_files() -> None:
    (clip,) = demo_clips(actors=["ada"], tasks=["bow"], takes=1)
    short = b"\n".join(clip.content.split(b"\n")[:160])
    mutations.check_broken(lambda seed: read_broken(short, seed), range(5_000))
    mutations.check_broken(lambda seed: read_broken(bvh(), seed), range(5_000))


@pytest.mark.slow
def test_damaged_real_files() -> None:
    for path in sorted((real_clips() / "bandai-namco-2").glob("wave-left-hand_*_001.bvh"))[:4]:
        content = path.read_bytes()
        mutations.check_broken(lambda seed, whole=content: read_broken(whole, seed), range(250))
