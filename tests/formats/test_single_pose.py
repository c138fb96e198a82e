"""A file of one frame is kept as a pose."""

from __future__ import annotations

import json

import numpy as np
import pytest

from app.analysis.analyze import analyze
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from tests.formats.c3d.files import c3d, marker_person, stacked
from tests.formats.npz.files import npy
from tests.formats.samples import bvh
from tests.formats.trc.files import trc
from tests.people import person

MARKERS, LABELS = stacked(marker_person(frames=20)[0])
ONE = MARKERS[:1]
FILES = {
    "c3d": c3d(ONE, LABELS, rate=200.0),
    "trc": trc(ONE, LABELS, values={"DataRate": "", "CameraRate": ""}),
    "npy": npy(person(frames=1).positions),
    "json": json.dumps(
        {
            "joint_names": list(person().skeleton.names),
            "positions": person(frames=1).positions.tolist(),
        }
    ).encode(),
}


@pytest.mark.parametrize("name", ["c3d", "trc"])
@pytest.mark.parametrize("rate", [None, 240.0])
def test_a_pose_of_markers_is_held_and_analyzed(name: str, rate: float | None) -> None:
    recording = read_recording(FILES[name])
    assert [c.code for c in recording.cautions] == ["single_pose"]
    assert np.ptp(recording.positions, axis=0).max() == 0
    motion = canonicalize(recording, frame_rate=rate)
    assert motion.missing_roles == ()
    assert analyze(motion).arrays["pose_cover"].shape[0] == 1


def test_each_format_may_have_a_single_frame() -> None:
    for content in (*FILES.values(), bvh(rows=("1 2 3 90 0 0 0 0 0",))):
        recording = read_recording(content)
        assert len(recording.positions) >= 10
        assert "single_pose" in [c.code for c in recording.cautions]


def test_two_frames_are_a_motion() -> None:
    assert len(read_recording(c3d(MARKERS[:2], LABELS)).positions) == 2
