"""JSON of 3-D keypoints gives a person, or is refused."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import FormatNotSupported, TooLarge, Unreadable
from app.formats.keypoints.reader import read_keypoints
from app.formats.npz.joint_layouts import LAYOUTS
from app.formats.read import read_recording
from app.formats.sniff import sniff
from app.kinedex_error import KinedexError
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.recording import Recording
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.people import ROLES, person

LAYOUT = {layout.title: layout for layout in LAYOUTS}
PERSON = person(frames=40).positions
PARTS = {
    "Hip": "upper_leg", "Ankle": "foot", "Wrist": "hand", "FootIndex": "toes", "BigToe": "toes",
    "UpLeg": "upper_leg", "Leg": "knee", "Foot": "foot", "Arm": "shoulder", "ForeArm": "elbow",
    "Hand": "hand",
}  # fmt: skip


def keypoints(title: str) -> list[list[list[float]]]:
    """The person's joints in the order of a layout; points of the face are at the head."""
    layout = LAYOUT[title]
    tracks = []
    for name in layout.names:
        side = next((s for s in ("Left", "Right") if name.startswith(s)), "")
        part = name.removeprefix(side)
        role = f"{side.lower()}_{PARTS.get(part, part.lower())}" if side else part.lower()
        known = role if role in ROLES else "head"
        if part in ("SmallToe", "Heel", "Pinky", "Index", "Thumb"):
            known = f"{side.lower()}_{'foot' if part in ('SmallToe', 'Heel') else 'hand'}"
        move = {"L": 0.05, "R": -0.05}.get(name[0], 0.0) if not side else 0.0
        nudge = [move, 0.01 if part == "SmallToe" else 0, 0.05 if not side else 0.0]
        nudge[1] -= 0.05 if part in ("SmallToe", "Heel", "Pinky", "Index", "Thumb") else 0
        nudge[2] -= 0.08 if "Ear" in part or part in ("Index", "Heel") else 0
        tracks.append(PERSON[:, ROLES.index(known)] + nudge)
    return np.stack(tracks, axis=1).round(6).tolist()


COCO = keypoints("COCO")
COCO_NAMES = [
    name.replace("Left", "left_").replace("Right", "right_").lower()
    for name in LAYOUT["COCO"].names
]


def with_confidence(rows: list[list[float]]) -> list[float]:
    return [number for row in rows for number in (*row, 0.9)]


def openpose() -> Any:
    return [{"version": 1.2, "people": [{"pose_keypoints_3d": with_confidence(f)}]} for f in COCO]


def mmpose() -> Any:
    names = {str(number): name for number, name in enumerate(COCO_NAMES)}
    return {
        "meta_info": {"keypoint_id2name": names, "fps": 50},
        "instance_info": [
            {"frame_id": n, "instances": [{"keypoints": f, "keypoint_scores": [1.0] * 17}]}
            for n, f in enumerate(COCO)
        ],
    }


def mmpose_inferencer() -> Any:
    return [[{"keypoints": f, "keypoint_scores": [1.0] * 17}] for f in COCO]


def easymocap() -> Any:
    return [[{"id": 3, "keypoints3d": [[*row, 0.8] for row in f]}] for f in COCO]


def by_name() -> Any:
    return {
        "fps": 50,
        "frames": [
            {"keypoints": dict(zip(COCO_NAMES, f, strict=True)), "time": n / 50}
            for n, f in enumerate(COCO)
        ],
    }


def objects() -> Any:
    return {
        "frames": [
            {
                "timestamp": n / 50,
                "world_landmarks": [
                    {"name": name, "x": x, "y": y, "z": z, "visibility": 1.0}
                    for name, (x, y, z) in zip(COCO_NAMES, f, strict=True)
                ],
            }
            for n, f in enumerate(COCO)
        ]
    }


def plain() -> Any:
    return {"joint_names": COCO_NAMES, "frame_rate": 50.0, "positions": COCO}


def bare() -> Any:
    return COCO


def numbered() -> Any:
    return {str(n): {"keypoints_3d": f} for n, f in enumerate(COCO)}


FORMS = (
    openpose, mmpose, mmpose_inferencer, easymocap, by_name, objects, plain, bare, numbered
)  # fmt: skip


def written(value: Any) -> bytes:
    return json.dumps(value).encode()


@pytest.mark.parametrize("form", FORMS)
def test_each_form_of_a_file_is_the_same_person(form: Any) -> None:
    content = written(form())
    assert sniff(content) == "json"
    recording = read_recording(content)
    assert recording.format == "json"
    has_rate = form in (mmpose, by_name, objects, plain)
    assert recording.frame_rate == (pytest.approx(50) if has_rate else None)
    motion = canonicalize(recording, frame_rate=50)
    assert motion.missing_roles == ()
    left_knee = motion.role_positions()[:, 0]
    truth = PERSON[:, ROLES.index(SUN_ROLES[0])]
    assert np.abs(left_knee - truth).max() < 1e-5


@pytest.mark.parametrize("title", ["COCO", "MediaPipe", "Halpe 26", "Human3.6M"])
def test_known_orders_of_joints_are_recognized(title: str) -> None:
    points = np.array(keypoints(title))
    points += np.random.default_rng(0).normal(scale=1e-3, size=points.shape)
    recording = read_keypoints(written({"fps": 30, "frames": points.tolist()}))
    (caution,) = (c for c in recording.cautions if c.code.startswith("joint_names"))
    assert (caution.code, title in caution.detail) == ("joint_names_guessed", True)
    assert canonicalize(recording).missing_roles == ()


def test_a_person_who_is_not_seen_in_some_frames() -> None:
    document = easymocap()
    document[7] = []
    document[8] = [{"id": 9, "keypoints3d": document[8][0]["keypoints3d"]}]
    document[9][0]["keypoints3d"][13] = [0, 0, 0, 0]
    recording = read_keypoints(written(document))
    codes = [c.code for c in recording.cautions]
    assert codes == ["several_people", "joint_names_guessed", "gaps_filled"]
    assert len(recording.positions) == len(COCO)


@pytest.mark.parametrize(
    "document",
    [
        {"people": [{"pose_keypoints_2d": [1.5, 2.5, 0.9] * 25}]},
        {"frames": [{"keypoints": [[1.5, 2.5]] * 17}]},
        {"annotations": [{"keypoints": [320, 240, 2] * 17, "id": 1}]},
        [{"instances": [{"keypoints": [[3, 4]] * 17}]}],
        [{"image_id": "1.jpg", "keypoints": [320.5, 240.5, 0.9, 300.5, 140.5, 0.7] * 9}],
        [{"landmarks": [{"x": 0.5, "y": 0.25, "z": -0.3}, {"x": 0.4, "y": 0.5, "z": 0.1}] * 9}],
    ],
)
def test_2d_keypoints_are_refused(document: Any) -> None:
    with pytest.raises(FormatNotSupported, match="2-D"):
        read_recording(written(document))


@pytest.mark.parametrize(
    ("document", "match"),
    [
        ({"frames": []}, "found"),
        ({"keypoints": {}}, "found"),
        ({"pose": 1}, "found pose"),
        ([1, 2], "found 2"),
        ([None, "x"], "none"),
        ([[[1, 2, "x"]]], "three numbers"),
        ([[[1, 2, 3], [1, 2]]], "same count"),
        ([[[1, 2, 3]], [[1, 2, 3], [4, 5, 6]]], "expected 1 keypoints"),
        ([{"people": [{"pose_keypoints_3d": [1, 2, 3, 4, 5]}]}], "three numbers"),
    ],
)
def test_the_error_says_what_was_expected(document: Any, match: str) -> None:
    with pytest.raises(Unreadable, match=match):
        read_keypoints(written(document))


def test_hostile_text_is_refused_quickly() -> None:
    for content in (b"[" * 10**6, b'{"frames":' * 10**5, b"[" + b"1" * 10_000 + b"]", b"[1,"):
        with cpu_seconds_below(1.0), pytest.raises((Unreadable, TooLarge)):
            read_keypoints(content)
    wide = written([[[0.5, 1.5, 2.5]] * 3000])
    with cpu_seconds_below(1.0), pytest.raises(TooLarge):
        read_keypoints(wide)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["frames", "people", "keypoints", "x", "y", "z", "id", "fps", "a"]),
            inner,
        )
    ),
    max_leaves=12,
)


@settings(max_examples=300, deadline=None)
@given(VALUES)
def test_any_value_raises_only_our_own_errors(value: Any) -> None:
    try:
        recording = read_keypoints(written(value))
    except KinedexError:
        return
    assert np.isfinite(recording.positions).all()


SMALL = written({**mmpose(), "instance_info": mmpose()["instance_info"][:3]})


def read_broken(seed: int) -> Recording:
    pieces = (*mutations.PIECES, b"null", b"[]", b"{}", b"1e400", b"NaN", b"-1e308")
    return read_keypoints(mutations.mutated(SMALL, seed, pieces))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 20 < mutations.check_broken(read_broken, range(400)) < 390


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))
