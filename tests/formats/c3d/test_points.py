"""The points of C3D files agree with ezc3d, or the file is refused."""

from __future__ import annotations

from pathlib import Path

import ezc3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import FormatNotSupported, Unreadable
from app.formats.c3d.points import read_points
from tests.formats.c3d.files import PROCESSORS, c3d, marker_person, stacked

MARKERS, LABELS = stacked(marker_person()[0])
PLAIN = c3d(MARKERS, LABELS)


def test_our_reader_and_ezc3d_agree(tmp_path: Path) -> None:
    theirs = ezc3d.c3d()
    point, analog = (theirs["parameters"][group] for group in ("POINT", "ANALOG"))
    point["RATE"]["value"], point["UNITS"]["value"] = [100], ["mm"]
    point["LABELS"]["value"] = LABELS
    analog["RATE"]["value"], analog["LABELS"]["value"] = [1000], ["force", "muscle"]
    hidden = MARKERS.copy()
    hidden[3:9, LABELS.index("LKNE")] = np.nan
    theirs["data"]["points"] = np.concatenate([hidden, np.ones_like(hidden[..., :1])], axis=2).T
    theirs["data"]["analogs"] = np.random.default_rng(0).normal(size=(1, 2, 10 * len(MARKERS)))
    theirs.write(str(tmp_path / "theirs.c3d"))
    ours = read_points((tmp_path / "theirs.c3d").read_bytes())
    assert list(ours.labels) == LABELS
    assert ours.frame_rate == 100
    assert np.allclose(ours.positions, hidden, atol=1e-3, equal_nan=True)
    for processor in ("intel", "dec"):  # ezc3d does not support MIPS
        for scale in (-1.0, 0.1):
            content = c3d(hidden, LABELS, processor=processor, scale=scale)
            (tmp_path / "ours.c3d").write_bytes(content)
            read = ezc3d.c3d(str(tmp_path / "ours.c3d"))["data"]["points"][:3].T
            assert np.allclose(read_points(content).positions, read, atol=1e-3, equal_nan=True)


def test_labels_in_more_than_one_parameter() -> None:
    many = np.tile(MARKERS[:3, :1], (1, 300, 1))
    labels = [f"point{i}" for i in range(300)]
    points = read_points(c3d(many, labels))
    assert list(points.labels) == labels


@pytest.mark.parametrize("keep", [0.3, 0.6, 0.85])
@pytest.mark.parametrize("scale", [-1.0, 0.1])
def test_a_truncated_file_is_refused(keep: float, scale: float) -> None:
    content = c3d(MARKERS, LABELS, scale=scale)
    data = MARKERS.shape[0] * MARKERS.shape[1] * (16 if scale < 0 else 8)
    with pytest.raises(Unreadable, match="expected 60 frames, found") as caught:
        read_points(content[: len(content) - round((1 - keep) * data)])
    assert caught.value.places[0].location.startswith("byte ")
    with pytest.raises(Unreadable):
        read_points(content[:600])


def test_a_file_without_its_last_frames_is_read() -> None:
    content = c3d(MARKERS, LABELS)
    points = read_points(content[: -2 * 16 * len(LABELS)])
    assert len(points.positions) == len(MARKERS) - 2
    assert [caution.code for caution in points.cautions] == ["frames_mismatch"]
    assert np.allclose(points.positions, MARKERS[:-2], atol=1e-3)


@pytest.mark.parametrize("declared", [6, 0, 999])
def test_a_wrong_number_of_analog_samples(declared: int) -> None:
    rates = {"ANALOG:USED": 6, "ANALOG:RATE": 1000.0}
    content = c3d(MARKERS, LABELS, analog=60, header_analog=declared, parameters=rates)
    points = read_points(content)
    assert np.allclose(points.positions, MARKERS, atol=1e-3)
    assert [caution.code for caution in points.cautions] == ["header_mismatch"]


def test_other_analog_parameters_do_not_change_a_right_header() -> None:
    rates = {"ANALOG:USED": 6, "ANALOG:RATE": 2000.0}
    points = read_points(c3d(MARKERS, LABELS, analog=60, parameters=rates))
    assert np.allclose(points.positions, MARKERS, atol=1e-3)
    assert points.cautions == ()


@pytest.mark.parametrize("processor", PROCESSORS)
def test_parameters_without_an_end_mark_end_with_their_blocks(processor: str) -> None:
    points = read_points(c3d(MARKERS, LABELS, processor=processor, end_mark=False))
    assert list(points.labels) == LABELS
    assert np.allclose(points.positions, MARKERS, atol=1e-2)


def test_residuals_that_are_all_negative_are_ignored() -> None:
    content = bytearray(c3d(MARKERS, LABELS))
    rows = np.frombuffer(content, "<f4", 4 * MARKERS.shape[0] * MARKERS.shape[1], 512 * (
        content[16] - 1
    )).reshape(-1, 4)  # fmt: skip
    rows[:, 3] = -1
    points = read_points(bytes(content))
    assert np.allclose(points.positions, MARKERS, atol=1e-3)
    assert [caution.code for caution in points.cautions] == ["residuals_ignored"]


def test_rotations_alone_are_named() -> None:
    content = bytearray(c3d(MARKERS, LABELS, parameters={"ROTATION:USED": 17}))
    content[2:4] = b"\0\0"
    with pytest.raises(FormatNotSupported, match="rotations"):
        read_points(bytes(content))


def test_more_frames_than_sixteen_bits_can_count() -> None:
    track = np.ones((70_000, 1, 3)) * np.arange(1, 70_001)[:, None, None]
    both = {"TRIAL:ACTUAL_START_FIELD": [1, 0], "TRIAL:ACTUAL_END_FIELD": [4464, 1]}
    full = {"POINT:FRAMES": -1}
    for last, parameters in ((None, both | full), (4464, both), (None, {"POINT:FRAMES": 70_000.0})):
        content = c3d(track, ["A"], parameters=parameters, last=last)
        assert len(read_points(content).positions) == 70_000
    saturated = {"POINT:FRAMES": -1}
    for last, more, codes in (
        (65535, {"POINT:LONG_FRAMES": 70_000.0}, []),
        (65535, {}, ["frames_mismatch"]),  # all fields are full, and more data follows
        (4464, {"POINT:FRAMES": 4464}, ["frames_mismatch"]),  # the count went over 65,536
    ):
        points = read_points(c3d(track, ["A"], parameters=saturated | more, last=last))
        assert len(points.positions) == 70_000
        assert [caution.code for caution in points.cautions] == codes
    unread = read_points(c3d(track, ["A"], parameters={"POINT:FRAMES": 1000}, last=1000))
    assert len(unread.positions) == 1000
    assert [caution.code for caution in unread.cautions] == ["data_unread"]
    telling = read_points(c3d(track[:50], ["A"], parameters={"POINT:FRAMES": 80}))
    assert len(telling.positions) == 50
    assert [caution.code for caution in telling.cautions] == ["frames_mismatch"]


@pytest.mark.parametrize(
    ("at", "value", "location"),
    [
        (2, b"\x00\x00", "byte 2"),  # no points
        (12, b"\x00\x00\x00\x00", "byte 12"),  # no scale
        (515, b"\x63", "byte 515"),  # no processor
        (16, b"\xff\x7f", "byte 16776192"),  # data beyond the end
        (0, b"\x63", "byte 50176"),  # parameters beyond the end
    ],
)
def test_impossible_headers_are_refused(at: int, value: bytes, location: str) -> None:
    content = PLAIN[:at] + value + PLAIN[at + len(value) :]
    with pytest.raises(Unreadable) as caught:
        read_points(content)
    assert caught.value.places[0].location == location


@settings(max_examples=40, deadline=None)
@given(
    frames=st.integers(1, 6),
    points=st.integers(1, 5),
    processor=st.sampled_from(sorted(PROCESSORS)),
    scale=st.sampled_from([-1.0, -0.01, 0.05]),
    analog=st.integers(0, 9),
    seed=st.integers(0, 1000),
)
def test_any_points_are_read_as_they_were_written(
    frames: int, points: int, processor: str, scale: float, analog: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-1000, 1000, (frames, points, 3)) + 1
    positions[rng.random((frames, points)) < 0.2] = np.nan
    labels = [f"P{i}" for i in range(points)]
    content = c3d(positions, labels, processor=processor, scale=scale, analog=analog)
    read = read_points(content)
    step = scale if scale > 0 else 1e-3
    assert np.allclose(read.positions, positions, atol=0.6 * step, equal_nan=True)
    assert read.cautions == ()
