"""C3D files of all processors and marker sets give a person, or are refused."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from app.errors import NotHuman, TooLarge, Unreadable
from app.formats.c3d.reader import read_c3d
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.formats.c3d.files import PROCESSORS, c3d, marker_person, stacked
from tests.people import ROLES

R = JointRole
TRACKS, TRUTH = marker_person()
MARKERS, LABELS = stacked(TRACKS)
PLAIN = c3d(MARKERS, LABELS)


def codes(recording: Recording | Motion) -> list[str]:
    return [caution.code for caution in recording.cautions]


def worst_error(motion: Motion, start: int = 0) -> dict[JointRole, float]:
    """The largest distance of each role from its true position, in meters."""
    truth = TRUTH[start : start + motion.frames, [ROLES.index(role) for role in SUN_ROLES]]
    apart = np.linalg.norm(motion.role_positions() - truth, axis=-1).max(axis=0)
    return {r: e for r, e in zip(SUN_ROLES, apart.tolist(), strict=True) if r in motion.roles}


def hide(*gaps: tuple[str, int, int]) -> FloatArray:
    """The markers of the person. gaps: a hidden label, its first frame, and the frame after."""
    hidden = MARKERS.copy()
    for label, start, end in gaps:
        hidden[start:end, LABELS.index(label)] = np.nan
    return hidden


@pytest.mark.parametrize("processor", PROCESSORS)
@pytest.mark.parametrize("scale", [-1.0, 0.1])
@pytest.mark.parametrize("analog", [0, 30])
def test_a_person_is_read_as_it_was_written(processor: str, scale: float, analog: int) -> None:
    content = c3d(MARKERS, LABELS, processor=processor, scale=scale, analog=analog)
    recording = read_recording(content)
    assert (recording.format, recording.frame_rate) == ("c3d", 100)
    assert (recording.metres_per_unit, recording.up_axis) == (0.001, "z")
    assert recording.cautions == ()
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert max(worst_error(motion).values()) < 0.001
    assert len(motion.roles) == len(JointRole)
    assert not codes(motion)


@pytest.mark.parametrize(
    ("unit", "scale"),
    [
        ("mm", 1),
        ("cm", 0.1),
        ("m", 0.001),
        ("Millimeters", 1),
        ("meters", 0.001),
        ("", 1),
        ("?", 1),
    ],
)
def test_units(unit: str, scale: float) -> None:
    content = c3d(MARKERS * scale, LABELS, parameters={"POINT:UNITS": unit})
    assert max(worst_error(canonicalize(read_c3d(content))).values()) < 0.001


def test_rate_axis_and_parameters_that_are_missing() -> None:
    no_rate = c3d(MARKERS, LABELS, rate=0)
    assert read_c3d(no_rate).frame_rate is None
    with pytest.raises(Unreadable, match="frame_rate"):
        canonicalize(read_c3d(no_rate))
    y_up = c3d(MARKERS[..., [0, 2, 1]] * [1, 1, -1], LABELS, parameters={"POINT:Y_SCREEN": "+Y"})
    motion = canonicalize(read_c3d(y_up))
    assert max(worst_error(motion).values()) < 0.001
    assert codes(motion) == []


@pytest.mark.parametrize(
    "rename",
    [
        str.lower,
        "Bob:{}".format,
        "Lab:Bob Smith:{}".format,
        lambda label: label[0] + "_" + label[1:] if label[0] in "LR" else label,
        lambda label: label.replace("ASI", "FWT").replace("PSI", "BWT"),  # CMU
        lambda label: label.replace("ASI", "IAS").replace("PSI", "IPS").replace("KNE", "FLE")
        .replace("KNM", "FME").replace("ANK", "FAL").replace("ANM", "TAM").replace("SHO", "SAE")
        .replace("ELB", "HLE").replace("ELM", "HME").replace("WRA", "RSP").replace("WRB", "USP"),
    ],
)  # fmt: skip
def test_other_names_of_the_same_markers(rename: object) -> None:
    assert callable(rename)
    recording = read_c3d(c3d(MARKERS, [rename(label) for label in LABELS]))
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert max(worst_error(motion).values()) < 0.001


def test_helen_hayes() -> None:
    names = {"ASI": "ASIS", "SHO": "Shoulder", "ELB": "Elbow", "KNE": "Knee", "ANK": "Ankle"}
    names |= {"KNM": "Knee.Medial", "ANM": "Ankle.Medial", "TOE": "Toe"}
    tracks = {
        f"{label[0]}.{names[label[1:]]}": track
        for label, track in TRACKS.items()
        if label[1:] in names
    }
    tracks |= {f"{side}.Wrist": (TRACKS[f"{side}WRA"] + TRACKS[f"{side}WRB"]) / 2 for side in "LR"}
    tracks["V.Sacral"] = (TRACKS["LPSI"] + TRACKS["RPSI"]) / 2
    tracks["Top.Head"] = (TRACKS["LFHD"] + TRACKS["RBHD"]) / 2
    motion = canonicalize(read_c3d(c3d(*stacked(tracks))))
    assert motion.missing_roles == ()
    errors = worst_error(motion)
    assert errors.pop(R.NECK) < 0.1  # between the shoulders
    assert max(errors.values()) < 0.06


def test_outer_markers_alone_are_accurate_enough() -> None:
    outer = {
        label: track for label, track in TRACKS.items() if label[1:] not in ("KNM", "ANM", "ELM")
    }
    motion = canonicalize(read_c3d(c3d(*stacked(outer))))
    assert motion.missing_roles == ()
    assert max(worst_error(motion).values()) < 0.051


def test_hip_joints_are_below_and_inside_the_pelvis_markers() -> None:
    motion = canonicalize(read_c3d(PLAIN))
    for side in ("left", "right"):
        role = JointRole(f"{side}_upper_leg")
        truth = TRUTH[:, ROLES.index(role)]
        assert np.linalg.norm(motion.positions[:, motion.roles[role]] - truth, axis=-1).max() < 0.06


def test_other_points_and_other_subjects_are_left_out() -> None:
    rng = np.random.default_rng(0)
    tracks = dict(TRACKS)
    extra = {"*12": 1.0, "": 1.0, "LKneeAngles": 90.0, "HEDO": 1.0, "Ann:LKNE": 1.0, "Ann:C7": 1.0}
    for label, size in extra.items():
        tracks[label] = rng.normal(size=(len(MARKERS), 3)) * size
    recording = read_c3d(c3d(*stacked(tracks), parameters={"POINT:ANGLES": ["HEDO"]}))
    assert not {*extra, "LKNE"} - {"LKNE"} & set(recording.skeleton.names)
    assert codes(recording) == ["several_subjects"]
    assert max(worst_error(canonicalize(recording)).values()) < 0.001


def test_the_point_seen_most_often_is_read_if_a_label_occurs_twice() -> None:
    ghost = np.full((len(MARKERS), 1, 3), np.nan)
    ghost[5:9] = [1e4, 2e4, 3e4]
    for positions, labels in (
        (np.concatenate([MARKERS, ghost], axis=1), [*LABELS, "LKNE"]),
        (np.concatenate([ghost, MARKERS], axis=1), ["LKNE", *LABELS]),
    ):
        recording = read_c3d(c3d(positions, labels))
        assert codes(recording) == ["duplicate_names"]
        assert max(worst_error(canonicalize(recording)).values()) < 0.001


def test_short_gaps_are_filled() -> None:
    content = c3d(hide(("LKNE", 10, 30), ("C7", 20, 40), ("RANK", 0, 6), ("LWRA", 55, 60)), LABELS)
    recording = read_c3d(content)
    assert codes(recording) == ["gaps_filled"]
    errors = worst_error(canonicalize(recording))
    # Gaps at the ends are filled with the nearest position, which is less accurate.
    assert max(errors.pop(role) for role in (R.RIGHT_FOOT, R.LEFT_HAND)) < 0.1
    assert max(errors.values()) < 0.01


@pytest.mark.parametrize("hidden", ["nan", "zeros", "residual"])
def test_every_way_to_mark_a_hidden_point(hidden: str) -> None:
    positions = MARKERS.copy()
    at = (slice(10, 20), LABELS.index("LKNE"))
    content = bytearray(c3d(positions, LABELS))
    start = len(content) - positions.shape[0] * positions.shape[1] * 16
    values = np.frombuffer(content, "<f4", offset=start).reshape(*positions.shape[:2], 4).copy()
    if hidden == "residual":
        values[at] = [1e4, 1e4, 1e4, -1]
    else:
        values[at] = [0, 0, 0, 0] if hidden == "zeros" else [np.nan, 1, 1, 0]
    recording = read_c3d(bytes(content[:start]) + values.tobytes())
    assert codes(recording) == ["gaps_filled"]
    assert max(worst_error(canonicalize(recording)).values()) < 0.002


def test_long_gaps_of_markers_that_are_not_needed_give_a_caution() -> None:
    gaps = ((label, 0, 55) for label in ("LKNM", "C7", "LTHI"))
    recording = read_c3d(c3d(hide(*gaps), LABELS))
    (caution,) = recording.cautions
    assert caution.code == "markers_left_out"
    assert all(label in caution.detail for label in ("LKNM", "C7", "LTHI"))
    assert not {"LKNM", "C7", "LTHI"} & set(recording.skeleton.names)
    errors = worst_error(canonicalize(recording))
    assert errors.pop(R.LEFT_KNEE) < 0.051
    assert errors.pop(R.NECK) < 0.1
    assert max(errors.values()) < 0.001


def test_labels_that_are_never_seen_are_absent() -> None:
    recording = read_c3d(c3d(hide(("LTOE", 0, 60), ("LKNM", 0, 60)), LABELS))
    assert recording.cautions == ()
    motion = canonicalize(recording)
    assert R.LEFT_TOES not in motion.roles
    assert motion.missing_roles == ()


def test_frames_without_markers_are_removed_at_the_ends() -> None:
    empty = np.full((40, *MARKERS.shape[1:]), np.nan)
    recording = read_c3d(c3d(np.concatenate([empty, MARKERS, empty]), LABELS))
    assert codes(recording) == ["frames_trimmed"]
    assert recording.start_frame == 40
    assert max(worst_error(canonicalize(recording)).values()) < 0.001


def test_roles_sent_by_the_client_may_be_markers() -> None:
    motion = canonicalize(read_c3d(PLAIN), roles={"left_hand": "LWRA"})
    assert motion.names[motion.roles[R.LEFT_HAND]] == "LWRA"
    strange = [f"point{i}" for i in range(len(LABELS))]
    with pytest.raises(NotHuman):
        canonicalize(read_c3d(c3d(MARKERS, strange)))
    roles = {"hips": "LASI", "neck": "C7", "left_knee": "LKNE", "right_knee": "RKNE"}
    names = {role: strange[LABELS.index(label)] for role, label in roles.items()}
    motion = canonicalize(read_c3d(c3d(MARKERS, strange)), roles=names)
    assert len(motion.roles) == 4


def test_a_file_without_labels_is_refused() -> None:
    with pytest.raises(Unreadable, match="labeled markers"):
        read_c3d(c3d(MARKERS, []))
    with pytest.raises(Unreadable, match="labeled markers"):
        read_c3d(c3d(np.full_like(MARKERS, np.nan), LABELS))


def test_a_small_file_cannot_use_gigabytes_or_minutes() -> None:
    content = bytearray(PLAIN)
    content[2:4], content[8:10] = b"\xff\xff", b"\xff\xff"
    tracemalloc.start()
    with cpu_seconds_below(1.0), pytest.raises((Unreadable, TooLarge)):
        read_c3d(bytes(content))
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()
    flicker = MARKERS[:1].repeat(3000, axis=0)
    flicker[1::2] = np.nan
    blinking = c3d(flicker, LABELS)
    with cpu_seconds_below(1.0):
        read_c3d(blinking)


SMALL = c3d(MARKERS[:8, :], LABELS, analog=3)


def read_broken(seed: int) -> Recording:
    head = len(SMALL) - 8 * len(LABELS) * 16
    if seed % 3:  # most damage is in the header and the parameters
        return read_c3d(mutations.mutated(SMALL[:head], seed) + SMALL[head:])
    return read_c3d(mutations.mutated(SMALL, seed))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 50 < mutations.check_broken(read_broken, range(500)) < 450


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))
