"""AMC files with ASF files agree with a slow twin, or are refused with the line."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import MotionNeeded, SkeletonNeeded, SkeletonNotNeeded, TooLarge, Unreadable
from app.formats.acclaim.amc import read_amc
from app.formats.bvh.reader import read_bvh
from app.formats.read import read_recording
from app.kinedex_error import KinedexError
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.recording import Recording
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.formats.acclaim.files import (
    ARM,
    ARM_ROWS,
    ROOT,
    Bone,
    Rows,
    acclaim_person,
    amc,
    asf,
    bone_starts,
)
from tests.formats.samples import bvh
from tests.people import ROLES
from tests.real_clips import real_clips


def codes(recording: Recording) -> list[str]:
    return [caution.code for caution in recording.cautions]


def line_of(motion: bytes) -> str:
    """The location in the error for the motion."""
    with pytest.raises(Unreadable) as caught:
        read_amc(motion, asf())
    (place,) = caught.value.places
    assert "expected" in place.message
    return place.location


def twin(bones: tuple[Bone, ...] = ARM, rows: Rows = ARM_ROWS) -> np.ndarray:
    return np.array([bone_starts(bones, row) for row in rows])


def test_a_simple_pair_of_files() -> None:
    recording = read_amc(amc(), asf())
    assert recording.format == "amc"
    assert recording.skeleton.names == ("root", "upper", "lower")
    assert recording.skeleton.parents.tolist() == [-1, 0, 1]
    assert recording.skeleton.end_parents.tolist() == [2]
    assert np.allclose(recording.skeleton.end_offsets, [[12, 0, 0]])
    assert recording.metres_per_unit == pytest.approx(0.0564444, abs=1e-6)
    assert recording.frame_rate is None
    assert recording.assumed_frame_rate == 120
    assert recording.translations is None
    assert recording.cautions == ()
    assert recording.positions.dtype == np.float32
    assert np.allclose(recording.positions, twin(), atol=1e-5)


MOTION, SKELETON = amc(), asf()


@pytest.mark.parametrize(
    ("motion", "skeleton"),
    [
        (MOTION.replace(b"\n", b"\r\n"), SKELETON.replace(b"\n", b"\r\n")),
        (MOTION.replace(b"\n", b"\r"), SKELETON.replace(b"\n", b"\r")),
        (MOTION.rstrip(), SKELETON.rstrip()),
        (b"\xef\xbb\xbf" + MOTION, b"\xef\xbb\xbf" + SKELETON),
        (MOTION.replace(b" ", b"\t "), SKELETON.replace(b" ", b"\t ")),
        (MOTION.replace(b"\n", b"\n\n"), SKELETON.replace(b"\n", b" \n\n")),
        (MOTION.replace(b"\nroot", b" # 1\nroot"), SKELETON.replace(b"deg", b"deg # ree")),
        (MOTION.replace(b"\nroot", b" // 1\n// 2\nroot"), SKELETON.replace(b"12\n", b"12 // x\n")),
        (MOTION.replace(b"upper", b"UPPER"), SKELETON.replace(b"name upper", b"name Upper")),
        (MOTION, SKELETON.replace(b"(", b" ").replace(b")", b" ").replace(b"deg", b"degrees")),
        (MOTION, SKELETON.replace(b"    dof", b"    bodymass 3\n    cofmass 1\n    dof")),
        (MOTION, SKELETON.replace(b"direction 0 1 0", b"direction 0 7 0")),
        (MOTION, SKELETON.replace(b":hierarchy", b":skin\nmesh.obj\n:hierarchy")),
        (MOTION, asf(degrees=False)),
        (amc(degrees=False), SKELETON),
        (amc(degrees=False).replace(b":RADIANS\n", b""), asf(degrees=False)),
        (MOTION.replace(b":DEGREES\n", b""), SKELETON),
        (MOTION.split(b":DEGREES\n")[1], SKELETON),
        (amc(first=101), SKELETON),
    ],
)  # fmt: skip
def test_dialects_of_the_same_files_give_the_same_recording(motion: bytes, skeleton: bytes) -> None:
    recording = read_recording(motion, skeleton)
    assert np.allclose(recording.positions, twin(), atol=1e-5)
    assert recording.cautions == ()


def test_a_person_is_read_as_it_was_written() -> None:
    skeleton, motion, truth = acclaim_person()
    found = canonicalize(read_recording(motion, skeleton))
    assert found.missing_roles == ()
    assert found.frame_rate == 120
    assert found.declared_frame_rate is None
    assert "frame_rate_assumed" in [caution.code for caution in found.cautions]
    expected = truth[:, [ROLES.index(role) for role in SUN_ROLES]]
    assert np.allclose(found.role_positions(), expected, atol=1e-4)
    with_hint = canonicalize(read_recording(motion, skeleton), frame_rate=60)
    assert with_hint.frame_rate == 60
    assert "frame_rate_assumed" not in [caution.code for caution in with_hint.cautions]


def test_a_frame_rate_in_the_file_is_used() -> None:
    declared = MOTION.replace(b":DEGREES", b":SAMPLES-PER-SECOND 60\n:DEGREES")
    assert read_amc(declared, SKELETON).frame_rate == 60
    odd = read_amc(declared.replace(b"SECOND 60", b"SECOND soon"), SKELETON)
    assert (odd.frame_rate, codes(odd)) == (None, ["frame_time_unusable"])


def test_channels_that_move_and_stretch() -> None:
    bones = (
        ROOT,
        Bone("a", 0, (0, 1, 0), 2.0, (0, 0, 90), "XYZ", ("l", "tx", "ry")),
        Bone("b", 1, (0, 1, 0), 1.0),
    )
    rows: Rows = [[[0, 0, 0, 0, 0, 90], [0.5, 3, 0], []]]
    recording = read_amc(amc(bones, rows), asf(bones))
    assert recording.translations is not None
    assert np.allclose(recording.positions, twin(bones, rows), atol=1e-5)
    assert np.allclose(recording.positions[0], [[0, 0, 0], [-3, 0, 0], [-5.5, 0, 0]], atol=1e-5)


def test_an_orientation_of_the_root_gives_a_caution() -> None:
    bones = (Bone("root", angles=(0, 90, 0), channels=ROOT.channels), *ARM[1:])
    recording = read_amc(amc(bones), asf(bones))
    assert np.allclose(recording.positions, twin(bones), atol=1e-5)
    assert codes(recording) == ["root_orientation"]


def test_a_bone_missing_in_a_frame_keeps_its_pose() -> None:
    lacking = MOTION.replace(b"upper 40 50 60\n", b"").replace(b"\n2\n", b"\n2\n")
    third = lacking + b"3\nroot 4 5 6 10 20 30\nupper 40 50 60\nlower 70 80\n"
    recording = read_amc(third, SKELETON)
    repeated = [[*ARM_ROWS[1][:1], ARM_ROWS[0][1], *ARM_ROWS[1][2:]]]
    assert np.allclose(recording.positions[1:2], twin(ARM, repeated), atol=1e-5)
    (caution,) = recording.cautions
    assert (caution.code, caution.joint) == ("bones_missing", "upper")
    assert "upper" in caution.detail


def test_bones_without_channels_in_the_motion_stay_at_rest() -> None:
    motion = b"".join(line + b"\n" for line in MOTION.splitlines() if b"lower" not in line)
    recording = read_amc(motion, SKELETON)
    assert np.allclose(recording.positions, twin(), atol=1e-5)
    assert codes(recording) == ["bones_missing"]


def test_a_file_that_is_cut_inside_a_name_is_read_to_its_last_whole_frame() -> None:
    for cut in (b"wer 70 80\n", b"r 70 80\n", b" 70 80\n"):
        recording = read_amc(MOTION.removesuffix(cut), SKELETON)
        assert codes(recording) == ["truncated"]
    with pytest.raises(Unreadable, match="expected a bone"):
        read_amc(MOTION + b"lox\n", SKELETON)


def test_an_incomplete_last_frame_is_left_out() -> None:
    last = b"root 4 5 6 10 20 30\nupper 40 50 60\nlower 70 80\n"
    for cut in (b"80\n", b"lower 70 80\n", b"upper 40 50 60\nlower 70 80\n", last):
        recording = read_amc(MOTION.removesuffix(cut), SKELETON)
        assert codes(recording) == ["truncated"]
        assert np.allclose(recording.positions, twin()[:1], atol=1e-5)


def test_frames_are_sorted_and_short_gaps_are_filled() -> None:
    def frame(number: int) -> bytes:
        return f"{number}\nroot {number} 0 0 0 0 0\nupper 0 0 0\nlower 0 0\n".encode()

    def places(*numbers: int) -> list[tuple[int, int] | None]:
        recording = read_amc(b":DEGREES\n" + b"".join(map(frame, numbers)), SKELETON)
        return [caution.frames for caution in recording.cautions]

    def roots(*numbers: int) -> tuple[list[float], list[str], float | None]:
        recording = read_amc(b":DEGREES\n" + b"".join(map(frame, numbers)), SKELETON)
        return recording.positions[:, 0, 0].tolist(), codes(recording), recording.assumed_frame_rate

    assert roots(5, 6, 7) == ([5, 6, 7], [], 120)
    assert roots(1, 5, 9) == ([1, 5, 9], [], 30)
    assert roots(3, 1, 2) == ([1, 2, 3], ["frames_out_of_order"], 120)
    assert roots(1, 2, 4, 5) == ([1, 2, 2, 4, 5], ["frames_missing"], 120)
    assert roots(9) == ([9], [], 120)
    assert places(0, 3, 1, 2, 4) == [(1, 4)]
    assert places(1, 2, 4, 5, 8, 9) == [(5, 7)]
    head = b":DEGREES\n"
    assert line_of(head + frame(1) + frame(2) + frame(2)) == "line 10"
    assert line_of(head + frame(1) + frame(2) + frame(999_999_999)) == "line 10"


@pytest.mark.parametrize(
    ("old", "new", "location"),
    [
        (b"upper 40 50 60", b"upper 40 x 60", "line 10"),
        (b"upper 40 50 60", b"upper 40 nan 60", "line 10"),
        (b"upper 40 50 60", b"upper 40 1e300 60", "line 10"),
        (b"upper 40 50 60", b"upper 40 5_0 60", "line 10"),
        (b"upper 40 50 60", b"upper 40 50 60 70", "line 10"),
        (b"upper 40 50 60", b"upper 40 50", "line 10"),
        (b"upper 40 50 60", b"tail 40 50 60", "line 10"),
        (b"upper 40 50 60", b"root 4 5 6 10 20 30", "line 10"),
        (b"root 1 2 3 0 0 0\n", b"", "line 4"),
        (b"\n1\n", b"\none\n", "line 4"),
        (MOTION, b":DEGREES\n", "line 1"),
        (MOTION, b"", "line 1"),
    ],
)
def test_an_unreadable_motion_is_refused_with_the_line(
    old: bytes, new: bytes, location: str
) -> None:
    assert old in MOTION
    assert line_of(MOTION.replace(old, new, 1)) == location


def test_one_file_without_the_other_is_refused_by_the_name_of_the_missing_file() -> None:
    with pytest.raises(SkeletonNeeded, match="`skeleton`") as missing:
        read_recording(MOTION)
    assert missing.value.places[0].location == "skeleton"
    for skeleton in (None, MOTION):
        with pytest.raises(MotionNeeded, match="AMC"):
            read_recording(SKELETON, skeleton)
    with pytest.raises(SkeletonNotNeeded):
        read_recording(bvh(), SKELETON)


def test_a_small_file_cannot_use_gigabytes_or_minutes() -> None:
    bones = (ROOT, *(Bone(f"b{i}", i, channels=("rx",)) for i in range(1000)))
    zeros: Rows = [[[0] * 6, *([0] for _ in range(1000))]]
    head = amc(bones, zeros)
    tracemalloc.start()
    with pytest.raises(TooLarge):
        read_amc(head + b"".join(b"%d\nroot 0 0 0 0 0 0\n" % i for i in range(2, 2000)), asf(bones))
    assert tracemalloc.get_traced_memory()[1] < 400_000_000
    tracemalloc.stop()
    with pytest.raises(TooLarge):
        read_amc(MOTION, SKELETON + b"# " * 2_000_000)
    wide = MOTION.replace(b"upper 40", b"upper 4" + b"0" * 3_000_000)
    with cpu_seconds_below(1.0), pytest.raises(KinedexError):
        read_amc(wide, SKELETON)


axes = st.permutations("XYZ").map("".join)
angles = st.tuples(*[st.floats(-180, 180, width=32)] * 3)
vectors = st.tuples(*[st.floats(-2, 2, width=32)] * 3)
channel_lists = st.lists(
    st.sampled_from(("tx", "ty", "tz", "rx", "ry", "rz", "l")), unique=True
).map(tuple)


@st.composite
def skeletons(draw: st.DrawFn) -> tuple[Bone, ...]:
    root_channels = draw(st.permutations(ROOT.channels)).copy()
    bones = [Bone("root", angles=draw(angles), order=draw(axes), channels=tuple(root_channels))]
    for index in range(1, draw(st.integers(2, 7))):
        parent = draw(st.integers(max(0, index - 2), index - 1))
        length = draw(st.floats(0, 5, width=32))
        turned = draw(angles), draw(axes), draw(channel_lists)
        bones.append(Bone(f"bone{index}", parent, draw(vectors), length, *turned))
    return tuple(bones)


@settings(max_examples=60, deadline=None)
@given(data=st.data(), bones=skeletons(), degrees=st.booleans(), frames=st.integers(1, 3))
def test_any_skeleton_and_motion_agree_with_the_slow_twin(
    data: st.DataObject, bones: tuple[Bone, ...], degrees: bool, frames: int
) -> None:
    rng = np.random.default_rng(data.draw(st.integers(0, 1000)))
    rows: Rows = [
        [rng.uniform(-90, 90, len(bone.channels)).tolist() for bone in bones] for _ in range(frames)
    ]
    recording = read_amc(amc(bones, rows, degrees=degrees), asf(bones, degrees=degrees))
    by_name = [recording.skeleton.names.index(bone.name) for bone in bones]
    assert np.allclose(recording.positions[:, by_name], twin(bones, rows), atol=1e-3)
    joint = recording.skeleton.names.index(bones[-1].name)
    assert recording.rotations is not None
    assert np.allclose(np.linalg.norm(recording.rotations[:, joint], axis=-1), 1, atol=1e-5)


PIECES = (*mutations.PIECES, b"begin\n", b"end\n", b":root\n", b"(", b"//", b"3\n", b"dof l\n")


def read_broken(seed: int) -> Recording:
    if seed % 2:
        return read_amc(mutations.mutated(MOTION, seed, PIECES), SKELETON)
    return read_amc(MOTION, mutations.mutated(SKELETON, seed, PIECES))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 50 < mutations.check_broken(read_broken, range(500)) < 450


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))


@pytest.mark.parametrize("clip", ["02_01", "02_03", "02_04"])
def test_real_legs_have_the_positions_of_the_same_clips_in_bvh(clip: str) -> None:
    folder = real_clips()
    skeleton = (folder / "cmu-asfamc" / "02.asf").read_bytes()
    ours = read_recording((folder / "cmu-asfamc" / f"{clip}.amc").read_bytes(), skeleton)
    theirs = read_bvh((folder / "cmu-bvh" / f"{clip}.bvh").read_bytes())
    pairs = {"Hips": "root"}
    for side in ("Left", "Right"):
        for one, other in (
            ("UpLeg", "femur"),
            ("Leg", "tibia"),
            ("Foot", "foot"),
            ("ToeBase", "toes"),
        ):
            pairs[side + one] = side[0].lower() + other
    a = ours.positions[:, [ours.skeleton.names.index(name) for name in pairs.values()]]
    b = theirs.positions[1:, [theirs.skeleton.names.index(name) for name in pairs]]
    a, b = (x - x.mean(axis=(0, 1), dtype=float) for x in (a, b))
    scale = (a * b).sum() / (b * b).sum()
    assert ours.metres_per_unit is not None
    millimeters = 1000 * ours.metres_per_unit * np.linalg.norm(a - scale * b, axis=-1)
    assert millimeters.max() < 0.01
