"""BVH files of many programs are read correctly, or refused with the line."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import TooLarge, Unreadable
from app.formats.bvh.reader import read_bvh
from app.formats.common.limits import MAX_JOINTS
from app.kinedex_error import KinedexError
from app.motion.skeleton.rotations import euler_to_quaternions, rotate
from tests.cpu_time import cpu_seconds_below
from tests.formats.samples import HIERARCHY, ROWS, SPINE, bvh
from tests.real_clips import real_clips


def line_of(content: bytes) -> str:
    """The location in the error for the content."""
    with pytest.raises(Unreadable) as caught:
        read_bvh(content)
    (place,) = caught.value.places
    assert "expected" in place.message
    return place.location


def test_shared_hierarchies_are_read_only() -> None:
    first, second = read_bvh(bvh()), read_bvh(bvh())
    assert first.skeleton.offsets.tolist() == second.skeleton.offsets.tolist()
    with pytest.raises(ValueError, match="read-only"):
        first.skeleton.offsets[0] = 1.0


def test_a_simple_file() -> None:
    recording = read_bvh(bvh())
    assert recording.skeleton.names == ("Hips", "Spine")
    assert recording.skeleton.parents.tolist() == [-1, 0]
    assert recording.skeleton.end_parents.tolist() == [1]
    assert recording.skeleton.end_offsets.tolist() == [[0, 5, 0]]
    assert recording.frame_rate == 30
    assert recording.translations is None
    assert recording.rotations is not None
    assert recording.positions.dtype == recording.rotations.dtype == np.float32
    assert recording.cautions == ()
    assert np.allclose(recording.positions[:, 0], [[1, 2, 3], [4, 5, 6]])
    assert np.allclose(recording.positions[:, 1], SPINE, atol=1e-5)


PLAIN = bvh()


@pytest.mark.parametrize(
    "content",
    [
        PLAIN.replace(b"\n", b"\r\n"),
        PLAIN.replace(b"\n", b"\r"),
        PLAIN.replace(b"  ", b"\t"),
        PLAIN.replace(b"\n", b" \n\n"),
        PLAIN.rstrip(b"\n"),
        b"\xef\xbb\xbf" + PLAIN,
        PLAIN.replace(b"\n{", b" {"),
        PLAIN.replace(b"Hips\n{", b"Hips{"),
        PLAIN.replace(b"End Site", b"End Site SpineTop"),
        PLAIN.replace(b"End Site", b"End"),
        PLAIN.replace(b"HIERARCHY", b"hierarchy").replace(b"ROOT", b"Root"),
        PLAIN.replace(b"Xrotation", b"XROTATION"),
        PLAIN.replace(b"OFFSET 0.0 10.0 0.0", b"OFFSET 0.0, 1.0e+1, 0.0"),
        PLAIN.replace(b"OFFSET 0.0 10.0 0.0", b"OFFSET 0,0 10,0 0,0"),
        PLAIN.replace(b"OFFSET 0.0 10.0 0.0", b"OFFSET 0,10,0"),
        PLAIN.replace(b"1 2 3 90 0 0", b"1,2,3,9e1,0,0,"),
        PLAIN.replace(b"1 2 3 90 0 0 0 0 0", b"1,0 2,0 3,0 90,0 0,0 0,0 0,0 0,0 0,0"),
        PLAIN.replace(b"1 2 3 90", b"1 2 3\n 90"),
        PLAIN.replace(b"0.0333333", b"3.33333e-2"),
        PLAIN.replace(b"0.0333333", b"0,0333333"),
        PLAIN.replace(b"Frame Time:", b"FrameTime: "),
        PLAIN.replace(b"Frames: 2", b"Frames 2"),
    ],
)
def test_dialects_of_the_same_file_give_the_same_recording(content: bytes) -> None:
    recording = read_bvh(content)
    assert np.allclose(recording.positions[:, 1], SPINE, atol=1e-5)
    assert recording.frame_rate == 30
    assert recording.cautions == ()


def test_position_channels_replace_the_offset_axis_by_axis() -> None:
    channels = "CHANNELS 4 Yposition Zrotation Xrotation Yrotation"
    hierarchy = HIERARCHY.replace("CHANNELS 3 Zrotation Xrotation Yrotation", channels)
    hierarchy = hierarchy.replace("OFFSET 0.0 10.0 0.0", "OFFSET 7 10 -7")
    recording = read_bvh(bvh(hierarchy, ("0 0 0 0 0 0 3 0 0 0", "0 0 0 0 0 0 -4 0 0 0")))
    assert np.allclose(recording.positions[:, 1], [[7, 3, -7], [7, -4, -7]])
    assert recording.translations is not None
    assert np.allclose(recording.translations[:, 1], [[7, 3, -7], [7, -4, -7]])


SIX_CHANNELS = HIERARCHY.replace("CHANNELS 3", "CHANNELS 6 Xposition Yposition Zposition")


def six_channels(*moves: str) -> bytes:
    """The simple file with position channels on its second joint. moves: three numbers a frame."""
    rows = [
        " ".join((*row.split()[:6], move, *row.split()[6:]))
        for row, move in zip(ROWS, moves, strict=True)
    ]
    return bvh(SIX_CHANNELS, rows)


def test_position_channels_that_are_always_zero_do_not_replace_the_offset() -> None:
    recording = read_bvh(six_channels("0 0 0", "0 0 0"))
    assert np.allclose(recording.positions, read_bvh(bvh()).positions, atol=1e-5)
    assert [caution.code for caution in recording.cautions] == ["position_channels_unused"]
    assert "Spine" in recording.cautions[0].detail
    assert recording.translations is None


def test_position_channels_that_move_once_replace_the_offset_always() -> None:
    recording = read_bvh(six_channels("0 0 0", "0 0 1"))
    assert recording.cautions == ()
    assert np.allclose(recording.positions[0, 1], recording.positions[0, 0])


def test_each_joint_turns_in_the_order_of_its_channels() -> None:
    hierarchy = HIERARCHY.replace(
        "Xposition Yposition Zposition Zrotation Xrotation Yrotation",
        "Yrotation Zposition Xrotation Yposition Zrotation Xposition",
    ).replace("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 2 Xrotation Zrotation")
    recording = read_bvh(bvh(hierarchy, ("10 3 20 2 30 1 40 50",)))
    root = euler_to_quaternions(np.radians([10.0, 20, 30]), "YXZ")
    spine = euler_to_quaternions(np.radians([40.0, 50]), "XZ")
    assert recording.rotations is not None
    assert np.allclose(recording.rotations[0], [root, spine], atol=1e-6)
    expected = np.array([1.0, 2, 3]) + rotate(root, np.array([0.0, 10, 0]))
    assert np.allclose(recording.positions[0, 1], expected, atol=1e-5)


def test_joints_without_channels_and_several_roots() -> None:
    hierarchy = HIERARCHY.replace("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 0")
    second = "ROOT Prop\n{\nOFFSET 1 2 3\nCHANNELS 1 Yrotation\n}\n"
    recording = read_bvh(bvh(hierarchy + second, ("0 0 0 0 0 0 45",)))
    assert recording.skeleton.parents.tolist() == [-1, 0, -1]
    assert np.allclose(recording.positions[0], [[0, 0, 0], [0, 10, 0], [1, 2, 3]])


@pytest.mark.parametrize("declared", ["0", "1", "3", "999999999999"])
def test_all_frames_are_read_if_the_declared_number_is_wrong(declared: str) -> None:
    recording = read_bvh(bvh(frames=declared))
    assert len(recording.positions) == 2
    assert [caution.code for caution in recording.cautions] == ["frames_mismatch"]


@pytest.mark.parametrize("frame_time", ["0", "-1", "nan", "inf", "soon", "1e-9", "33", ""])
def test_an_impossible_frame_time_gives_no_frame_rate(frame_time: str) -> None:
    recording = read_bvh(bvh(frame_time=frame_time))
    assert recording.frame_rate is None
    (caution,) = recording.cautions
    assert caution.code == "frame_time_unusable"
    assert "line 18" in caution.detail


@pytest.mark.parametrize(
    ("frame_time", "rate"),
    [("0.0083333", 120), (".008333", 120), ("0.016667", 60), ("0.033367", 29.97), ("0.04", 25)],
)
def test_rates_near_whole_numbers_are_rounded(frame_time: str, rate: float) -> None:
    assert read_bvh(bvh(frame_time=frame_time)).frame_rate == pytest.approx(rate, abs=0.003)


def test_names_with_any_encoding_with_spaces_and_duplicates() -> None:
    latin = HIERARCHY.replace("Spine", "Rücken wirbel").encode("latin-1")
    names = read_bvh(latin + bvh()[len(HIERARCHY) :]).skeleton.names
    assert names == ("Hips", "Rücken wirbel")
    twice = read_bvh(bvh(HIERARCHY.replace("Spine", "Hips")))
    assert twice.skeleton.names == ("Hips", "Hips")
    assert [caution.code for caution in twice.cautions] == ["duplicate_names"]


@pytest.mark.parametrize(
    ("old", "new", "location"),
    [
        (ROWS[0], "1 2 3 nan 0 0 0 0 0", "line 19"),
        (ROWS[0], "1 2 3 inf 0 0 0 0 0", "line 19"),
        (ROWS[0], "1 2 3 1e300 0 0 0 0 0", "line 19"),
        (ROWS[0], "1 2 3 1_0 0 0 0 0 0", "line 19"),
        (ROWS[0], "1 2 3 x 0 0 0 0 0", "line 19"),
        (ROWS[0], ROWS[0] + " 7", "line 19"),
        (ROWS[0], "1 2 3", "line 19"),
        (ROWS[1], "1 2 3", "line 20"),
        ("OFFSET 0.0 10.0 0.0", "OFFSET 0.0 10.0", "line 8"),
        ("OFFSET 0.0 10.0 0.0", "OFFSET 0.0 nan 0.0", "line 8"),
        ("CHANNELS 3", "CHANNELS 4", "line 10"),
        ("CHANNELS 3", "CHANNELS 99999999999", "line 9"),
        ("CHANNELS 3", "CHANNELS -1", "line 9"),
        ("CHANNELS 3 Zrotation", "CHANNELS 3 Wrotation", "line 9"),
        ("6 Xposition Yposition", "6 Xposition Xposition", "line 5"),
        ("JOINT Spine", "JOINT", "line 6"),
        ("JOINT Spine", "JOINT Sp\x00ine", "line 6"),
        ("JOINT Spine", "LIMB Spine", "line 6"),
        ("    OFFSET 0.0 10.0 0.0\n", "", "line 13"),
        ("Frames: 2", "Frames: many", "line 17"),
        ("Frame Time", "Time", "line 18"),
        ("MOTION", "EMOTION", "line 16"),
        ("  }\n}\n", "  }\n", "line 15"),
        ("  }\n}\n", "  }\n}\n}\n", "line 16"),
        ("HIERARCHY", "ANARCHY", "line 1"),
    ],
)
def test_an_unreadable_file_is_refused_with_the_line(old: str, new: str, location: str) -> None:
    content = bvh()
    assert old.encode() in content
    assert line_of(content.replace(old.encode(), new.encode(), 1)) == location


def test_every_truncated_file_is_refused_or_read() -> None:
    content = bvh()
    for length in range(len(content)):
        try:
            recording = read_bvh(content[:length])
        except Unreadable:
            continue
        else:
            short = len(recording.positions) < 2
            assert short == any(c.code == "frames_mismatch" for c in recording.cautions)


def test_files_without_frames_or_channels_are_refused() -> None:
    assert line_of(bvh(rows=())) == "line 19"
    assert line_of(bvh("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\n", ("0",))) == "line 1"


def test_nested_joints_are_read_up_to_the_limit() -> None:
    def nested(depth: int) -> bytes:
        down = "".join(f"JOINT j{i} {{ OFFSET 0 1 0 CHANNELS 0\n" for i in range(depth - 1))
        root = "HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 1 Xrotation\n"
        return bvh(root + down + "}" * depth + "\n", ("90",))

    recording = read_bvh(nested(MAX_JOINTS))
    assert np.allclose(recording.positions[0, -1], [0, 0, MAX_JOINTS - 1], atol=1e-2)
    with pytest.raises(TooLarge):
        read_bvh(nested(MAX_JOINTS + 1))


def test_a_small_file_cannot_use_gigabytes() -> None:
    joints = "".join(f"JOINT j{i} {{ OFFSET 0 1 0 }}\n" for i in range(MAX_JOINTS - 1))
    hierarchy = f"HIERARCHY ROOT r {{ OFFSET 0 0 0 CHANNELS 1 Xrotation\n{joints}}}\n"
    content = bvh(hierarchy, ("0",)) + b"0\n" * 20_000
    tracemalloc.start()
    with pytest.raises(TooLarge):
        read_bvh(content)
    assert tracemalloc.get_traced_memory()[1] < 100_000_000
    tracemalloc.stop()


@pytest.mark.parametrize("before", ["Frames:", "Frame Time:", "MOTION", "OFFSET 0.0 10.0"])
def test_long_lines_of_blanks_cost_no_time(before: str) -> None:
    content = bvh().replace(before.encode(), before.encode() + b" " * 200_000 + b"x y", 1)
    with cpu_seconds_below(1.0), pytest.raises(KinedexError):
        read_bvh(content)


def test_memory_is_a_few_times_the_array() -> None:
    rows = tuple(" ".join(["0.123456"] * 9) for _ in range(20_000))
    content = bvh(rows=rows)
    tracemalloc.start()
    read_bvh(content)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    working_set = 5_000_000
    assert peak < 5 * (20_000 * 9 * 8) + working_set


@settings(max_examples=150, deadline=2000)
@given(data=st.data())
def test_damaged_files_raise_only_our_own_errors(data: st.DataObject) -> None:
    content = bytearray(bvh())
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content)))
        length = data.draw(st.integers(0, 12))
        snippets = st.sampled_from(
            [b"", b"{", b"}", b"\n", b"nan", b"1e999", b"-", b"\x00", b"\xff", b"MOTION\n", b"End "]
        )
        content[start : start + length] = data.draw(st.one_of(snippets, st.binary(max_size=4)))
    try:
        recording = read_bvh(bytes(content))
    except KinedexError:
        return
    assert np.isfinite(recording.positions).all()


@settings(max_examples=200, deadline=2000)
@given(st.binary(max_size=200))
def test_noise_raises_only_our_own_errors(noise: bytes) -> None:
    for content in (noise, HIERARCHY.encode() + b"MOTION\n" + noise):
        with pytest.raises(KinedexError):
            read_bvh(content)


def test_real_dialects() -> None:
    folder = real_clips()
    bandai = read_bvh((folder / "bandai-namco-1" / "walk_normal_002.bvh").read_bytes())
    assert bandai.frame_rate == 30
    assert bandai.translations is not None
    hips = bandai.skeleton.names.index("Hips")
    assert np.allclose(bandai.translations[0, hips], [1.63921, 92.1273, 0], atol=1e-3)
    cmu = read_bvh((folder / "cmu-bvh" / "02_01.bvh").read_bytes())
    assert (len(cmu.positions), len(cmu.skeleton), cmu.frame_rate) == (344, 31, 120)
    assert cmu.translations is None


def test_too_many_joints_are_refused_with_the_line() -> None:
    joints = b"".join(
        b"JOINT j%d\n{\nOFFSET 0 1 0\nCHANNELS 0\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\n" % i
        for i in range(3000)
    )
    root = b"HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 0\n"
    with pytest.raises(TooLarge) as refusal:
        read_bvh(root + joints + b"}\nMOTION\nFrames: 1\nFrame Time: 0.1\n\n")
    assert refusal.value.places[0].location.startswith("line ")
