"""CSV of Motive and Nexus and TSV of Qualisys give a person, or are refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import FormatNotSupported, Unreadable
from app.formats.read import read_recording
from app.formats.tables.cells import read_numbers
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.formats import mutations
from tests.formats.c3d.files import marker_person, stacked
from tests.formats.tables.files import motive, nexus, qtm
from tests.people import ROLES, person

MARKERS, LABELS = stacked(marker_person()[0])
TRUTH = marker_person()[1]
PERSON = person(frames=60).positions
BONES = {
    "hips": "Hip", "chest": "Chest", "neck": "Neck", "head": "Head", "shoulder": "UArm",
    "elbow": "FArm", "hand": "Hand", "upper_leg": "Thigh", "knee": "Shin", "foot": "Foot",
    "toes": "Toe",
}  # fmt: skip


def y_up(positions: FloatArray) -> FloatArray:
    return np.asarray(positions[..., [0, 2, 1]] * [1, 1, -1])


def worst_error(recording: Recording, start: int = 0) -> float:
    """The largest distance of a role from its true position, in meters."""
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    truth = TRUTH[start : start + motion.frames, [ROLES.index(role) for role in SUN_ROLES]]
    return float(np.linalg.norm(motion.role_positions() - truth, axis=-1).max())


def bone_name(role: JointRole) -> str:
    side, _, part = role.partition("_")
    return f"{side[0].upper()}{BONES[part]}" if part else BONES[role]


@pytest.mark.parametrize("version", ["1.2", "1.25"])
@pytest.mark.parametrize(("unit", "scale"), [("Meters", 0.001), ("Millimeters", 1)])
def test_markers_of_motive(version: str, unit: str, scale: float) -> None:
    names = [f"Ada:{label}" for label in LABELS]
    content = motive(
        scale * y_up(MARKERS), names, unit=unit, version=version, parents=version == "1.25"
    )
    recording = read_recording(content)
    assert (recording.format, recording.frame_rate, recording.cautions) == ("csv", 120, ())
    assert recording.metres_per_unit == pytest.approx(0.001 / scale)
    assert worst_error(recording) < 0.001


@pytest.mark.parametrize("mark", [":", "_"])
def test_bones_of_motive_are_joints(mark: str) -> None:
    names = [f"Ada 1{mark}{bone_name(role)}" for role in ROLES]
    collars = np.stack([0.7 * PERSON[:, 2] + 0.3 * PERSON[:, joint] for joint in (4, 7)], axis=1)
    positions = np.concatenate([PERSON, collars], axis=1)
    names += [f"Ada 1{mark}{side}Shoulder" for side in "LR"]
    recording = read_recording(motive(positions, names, kind="Bone"))
    assert worst_error(recording) < 1e-5
    assert canonicalize(recording).roles[JointRole.LEFT_TOES] is not None


def test_markers_of_a_skeleton_as_solved() -> None:
    recording = read_recording(motive(y_up(MARKERS) / 1000, LABELS, kind="Bone Marker"))
    assert worst_error(recording) < 0.001


def test_bones_in_local_coordinates_are_refused() -> None:
    content = motive(PERSON, [bone_name(role) for role in ROLES], kind="Bone", space="Local")
    with pytest.raises(FormatNotSupported, match="global"):
        read_recording(content)


@pytest.mark.parametrize("devices", [False, True])
@pytest.mark.parametrize(("units", "separator"), [(True, ","), (True, "\t"), (False, ",")])
def test_trajectories_of_nexus(devices: bool, units: bool, separator: str) -> None:
    content = nexus(MARKERS, LABELS, devices=devices, units=units, separator=separator)
    recording = read_recording(content)
    assert (recording.format, recording.frame_rate, recording.cautions) == ("csv", 100, ())
    assert (recording.metres_per_unit, recording.up_axis) == (0.001, "z")
    assert worst_error(recording) < 0.001


def test_only_trajectories_of_nexus_are_motion() -> None:
    with pytest.raises(Unreadable, match="Trajectories"):
        read_recording(b"Devices\r\n1000\r\n,,Force\r\nFrame,Sub Frame,Fx\r\n1,0,2.5\r\n")


@pytest.mark.parametrize("leading", [False, True])
@pytest.mark.parametrize("titles", [False, True])
def test_markers_of_qualisys(leading: bool, titles: bool) -> None:
    recording = read_recording(qtm(MARKERS, LABELS, leading=leading, titles=titles))
    assert (recording.format, recording.frame_rate, recording.cautions) == ("tsv", 200, ())
    assert worst_error(recording) < 0.001


def test_a_file_of_qualisys_without_markers_is_refused() -> None:
    with pytest.raises(FormatNotSupported) as caught:
        read_recording(qtm(MARKERS[:, :1], [], data="6D"))
    assert "6D" in caught.value.places[0].message


@pytest.mark.parametrize("write", [nexus, qtm])
def test_hidden_markers_are_empty_cells(write: Callable[..., bytes]) -> None:
    hidden = MARKERS.copy()
    hidden[10:20, LABELS.index("LKNE")] = np.nan
    hidden[5, -1] = np.nan
    recording = read_recording(write(hidden, LABELS))
    assert [c.code for c in recording.cautions] == ["gaps_filled"]
    assert worst_error(recording) < 0.03


@pytest.mark.parametrize("write", [motive, nexus, qtm])
def test_the_error_names_the_line(write: Callable[..., bytes]) -> None:
    content = write(MARKERS, LABELS)
    lines = content.split(b"\n")
    number = len(lines) - 10
    lines[number] = lines[number].replace(b".", b"x", 1)
    with pytest.raises(Unreadable, match="expected a number") as caught:
        read_recording(b"\n".join(lines))
    assert caught.value.places[0].location == f"line {number + 1}"


def test_headers_without_numbers_are_refused() -> None:
    for content in (motive(MARKERS, LABELS), nexus(MARKERS, LABELS), qtm(MARKERS, LABELS)):
        for length in (40, 200, content.rindex(b"MARKER" if b"MARKER" in content else b"Z")):
            with pytest.raises((Unreadable, FormatNotSupported)):
                read_recording(content[:length])


NUMBERS = st.one_of(st.none(), st.floats(-1e8, 1e8))


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.lists(NUMBERS, min_size=3, max_size=3), min_size=1, max_size=6),
    st.sampled_from([b",", b";", b"\t"]),
    st.booleans(),
)
def test_every_number_of_a_table_is_read(
    rows: list[list[float | None]], separator: bytes, ends: bool
) -> None:
    lines = [
        separator.join(b"" if n is None else repr(n).encode() for n in row) + separator * ends
        for row in rows
    ]
    filled = [line for line in lines if line.strip()]
    table = read_numbers(b"\n".join(lines), 1, 3, separator)
    wanted = [row for row, line in zip(rows, lines, strict=True) if line in filled]
    expected = np.array([[np.nan if n is None else n for n in row] for row in wanted])
    assert np.array_equal(table, expected.reshape(-1, 3), equal_nan=True)


SMALL = [write(MARKERS[:4, :14], LABELS[:14]) for write in (motive, nexus, qtm)]


def read_broken(seed: int) -> Recording:
    pieces = (*mutations.PIECES, b",", b"\t", b"Frame", b"X,Y,Z")
    return read_recording(mutations.mutated(SMALL[seed % 3], seed, pieces))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 50 < mutations.check_broken(read_broken, range(600)) < 590


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))
