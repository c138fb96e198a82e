"""The same take as BVH and as AMC: each finds the other first, by every method without a model.

The two files of CMU differ in their skeletons: the BVH has no thorax bone, so its arms and neck are
12 cm off.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.search.example.by_example import COMPARED
from app.search.example.methods import LEARNED, Method
from app.search.example.window_distances import SCALE
from tests.real_clips import manifest, real_clips
from tests.search.local_index import LocalLibrary

TAKES = ("02_01", "02_03", "02_04")


@lru_cache(maxsize=1)
def _described() -> Mapping[str, Mapping[str, np.ndarray]]:
    """All BVH and AMC files of CMU by path."""
    skeleton = (real_clips() / "cmu-asfamc" / "02.asf").read_bytes()
    clips = {}
    for row in manifest():
        if row["path"].startswith(("cmu-bvh", "cmu-asfamc")):
            content = (real_clips() / row["path"]).read_bytes()
            recording = read_recording(content, skeleton if row["path"].endswith("amc") else None)
            motion = canonicalize(recording, frame_rate=float(row["fps"]))
            clips[row["path"]] = describe_for_search(motion, (*COMPARED, SCALE.vectors)).arrays
    return clips


@pytest.mark.parametrize("method", [method for method in Method if method not in LEARNED])
@pytest.mark.parametrize("take", TAKES)
def test_each_file_of_a_take_finds_the_other_first(take: str, method: Method) -> None:
    clips = _described()
    bvh, amc = f"cmu-bvh/{take}.bvh", f"cmu-asfamc/{take}.amc"
    for query, other in ((bvh, amc), (amc, bvh)):
        ranked = LocalLibrary(clips).rank(clips[query], method, exclude=frozenset([query]))
        assert ranked.ids[0] == other
