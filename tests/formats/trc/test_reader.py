"""TRC files of markers and of joints give a person, or are refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import NotHuman, TooLarge, Unreadable
from app.formats.bvh.frames import MAX_FRAMES
from app.formats.read import read_recording
from app.formats.sniff import sniff
from app.formats.trc.reader import read_trc
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.formats.c3d.files import marker_person, stacked
from tests.formats.trc.files import trc
from tests.people import ROLES, person

MARKERS, LABELS = stacked(marker_person()[0])
TRUTH = marker_person()[1]
JOINT_NAMES = (
    "RHip RKnee RAnkle RBigToe LHip LKnee LAnkle LBigToe Nose LEar REar"
    " RShoulder RElbow RWrist LShoulder LElbow LWrist"
)


def worst_error(recording: Recording) -> float:
    """The largest distance of a role from its true position, in meters."""
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    truth = TRUTH[: motion.frames, [ROLES.index(role) for role in SUN_ROLES]]
    return float(np.linalg.norm(motion.role_positions() - truth, axis=-1).max())


def y_up(positions: FloatArray) -> FloatArray:
    return np.asarray(positions[..., [0, 2, 1]] * [1, 1, -1])


@pytest.mark.parametrize("separator", ["\t", ",", ";"])
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_a_person_is_read_as_it_was_written(separator: str, newline: str) -> None:
    content = trc(y_up(MARKERS), LABELS, separator=separator, newline=newline)
    recording = read_recording(content)
    assert (recording.format, recording.frame_rate) == ("trc", 100)
    assert (recording.metres_per_unit, recording.cautions) == (0.001, ())
    assert worst_error(recording) < 0.001


def test_z_up_as_cortex_writes_it() -> None:
    assert worst_error(read_trc(trc(MARKERS, LABELS))) < 0.001


@pytest.mark.parametrize(("unit", "scale"), [("m", 0.001), ("cm", 0.1), ("Meters", 0.001)])
def test_units(unit: str, scale: float) -> None:
    assert worst_error(read_trc(trc(y_up(MARKERS) * scale, LABELS, unit=unit))) < 0.001


def test_decimal_commas() -> None:
    content = trc(y_up(MARKERS), LABELS).replace(b".", b",")
    assert worst_error(read_trc(content)) < 0.001


def joints_without_hips_and_neck() -> tuple[FloatArray, list[str]]:
    """The joints of pose estimation: hips, neck and head follow from others."""
    recording = person(frames=60)
    names = JOINT_NAMES.split()
    parts = {"Hip": "upper_leg", "Ankle": "foot", "BigToe": "toes", "Wrist": "hand"}
    tracks = []
    for name in names:
        part = parts.get(name[1:], name[1:].lower())
        role = f"{'left' if name[0] == 'L' else 'right'}_{part}"
        offset = {"LEar": 0.07, "REar": -0.07}.get(name, 0.0)
        known = role if role in ROLES else "head"
        tracks.append(recording.positions[:, ROLES.index(known)] + [offset, 0, 0])
    return np.stack(tracks, axis=1), names


def test_joints_of_pose_estimation_have_hips_neck_and_head() -> None:
    positions, names = joints_without_hips_and_neck()
    motion = canonicalize(read_trc(trc(positions, names, unit="m")))
    assert motion.missing_roles == ()
    assert not [c for c in motion.cautions if c.code != "frame_rate_suspect"]
    place = dict(zip(SUN_ROLES, motion.role_positions()[0], strict=True))
    hips = [positions[0, names.index(name)] for name in ("LHip", "RHip")]
    ears = [positions[0, names.index(name)] for name in ("LEar", "REar")]
    assert np.allclose(place[SUN_ROLES[4]], np.mean(hips, axis=0), atol=1e-5)
    assert np.allclose(place[SUN_ROLES[10]], np.mean(ears, axis=0), atol=1e-5)


def test_hidden_markers_are_empty_cells_or_zeros() -> None:
    hidden = y_up(MARKERS)
    hidden[10:20, LABELS.index("LKNE")] = np.nan
    for mark in ("", "NaN", "0.0", " "):
        recording = read_trc(trc(hidden, LABELS, hidden=mark))
        assert [c.code for c in recording.cautions] == ["gaps_filled"]
        assert worst_error(recording) < 0.02


def test_the_rate_is_that_of_the_times_if_the_header_gives_none() -> None:
    content = trc(y_up(MARKERS), LABELS, rate=50, values={"DataRate": "0", "CameraRate": ""})
    assert read_trc(content).frame_rate == pytest.approx(50)


def test_a_wrong_number_of_frames_gives_a_caution() -> None:
    recording = read_trc(trc(y_up(MARKERS), LABELS, values={"NumFrames": "99"}))
    assert [c.code for c in recording.cautions] == ["frames_mismatch"]


def test_labels_without_empty_cells_between_them() -> None:
    content = trc(y_up(MARKERS), LABELS)
    lines = content.split(b"\n")
    lines[3] = b"\t".join(cell for cell in lines[3].split(b"\t") if cell)
    assert worst_error(read_trc(b"\n".join(lines))) < 0.001


@pytest.mark.parametrize(
    ("damage", "location", "match"),
    [
        ((b"Frame#", b"Bild"), "line 4", "labels of markers"),
        ((b"\n7\t0.06", b"\n7\tnoon"), "line 13", "expected a number"),
        ((b"\n7\t0.06", b"\n7\t1e99"), "line 13", "within"),
    ],
)
def test_the_error_names_the_line(damage: tuple[bytes, bytes], location: str, match: str) -> None:
    with pytest.raises(Unreadable, match=match) as caught:
        read_trc(trc(y_up(MARKERS), LABELS).replace(*damage))
    assert caught.value.places[0].location == location


def test_headers_without_frames_are_refused() -> None:
    head = b"\n".join(trc(y_up(MARKERS), LABELS).split(b"\n")[:6])
    for cut in (head, head[:300], b"PathFileType\t4\n"):
        with pytest.raises(Unreadable):
            read_recording(cut)


def test_a_wide_header_cannot_use_gigabytes() -> None:
    labels = b"\t\t\t".join(b"M%d" % n for n in range(20_000))
    axes = b"\t".join(b"X%d\tY%d\tZ%d" % (n, n, n) for n in range(20_000))
    head = b"PathFileType\t4\nDataRate\n100\nFrame#\tTime\t" + labels + b"\n\t\t" + axes + b"\n"
    with pytest.raises(TooLarge):
        read_trc(head + b"1\t0\t1\t2\t3\n" * 1000)


def test_more_lines_than_a_clip_may_have_frames_are_refused_unread() -> None:
    head = b"PathFileType\t4\nDataRate\n100\nFrame#\tTime\tA\n\t\tX1\tY1\tZ1\n"
    with cpu_seconds_below(1.0, "a million lines"), pytest.raises(TooLarge, match="lines"):
        read_trc(head + b"1\t0\t1\t2\t3\n" * (MAX_FRAMES + 1))


def test_markers_of_an_object_are_refused_with_their_labels() -> None:
    box = np.random.default_rng(0).normal(size=(20, 4, 3))
    with pytest.raises(NotHuman):
        canonicalize(read_trc(trc(box, ["a", "b", "c", "d"], unit="m")))


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.floats(-800, 800, width=32), min_size=12, max_size=12),
    st.sampled_from(["\t", ",", ";"]),
)
def test_every_number_is_read_as_it_was_written(numbers: list[float], separator: str) -> None:
    positions = np.array(numbers, dtype=np.float64).reshape(2, 2, 3) + 0.5
    recording = read_trc(trc(positions, ["one", "two"], separator=separator))
    assert np.array_equal(recording.positions, positions.astype(np.float32))


def read_broken(seed: int) -> Recording:
    pieces = (*mutations.PIECES, b"\t", b"\t\t\t", b"X1", b"Frame#")
    return read_trc(mutations.mutated(SMALL, seed, pieces))


SMALL = trc(y_up(MARKERS[:5, :12]), LABELS[:12])


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 50 < mutations.check_broken(read_broken, range(500)) < 490


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))


def test_the_format_is_recognized() -> None:
    assert sniff(SMALL) == "trc"
    assert sniff(b'"PathFileType",4\n') == "trc"
