"""MVNX files of Xsens give a person with rotations, or are refused."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import Unreadable
from app.formats.mvnx.reader import PARENTS, read_mvnx
from app.formats.read import read_recording
from app.formats.sniff import sniff
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import multiply
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.people import swaying_rotations

R = JointRole
NAMES = ("Pelvis", *PARENTS)
ABOVE = np.array([-1, *(NAMES.index(PARENTS[name]) for name in NAMES[1:])])
OFFSETS = {
    "Pelvis": (0, 0, 0.9), "L5": (0, 0, 0.1), "L3": (0, 0, 0.1), "T12": (0, 0, 0.1),
    "T8": (0, 0, 0.1), "Neck": (0, 0, 0.12), "Head": (0, 0, 0.09), "Shoulder": (0, 0.03, 0.08),
    "UpperArm": (0, 0.14, 0), "ForeArm": (0, 0.28, 0), "Hand": (0, 0.25, 0),
    "UpperLeg": (0, 0.09, 0), "LowerLeg": (0, 0, -0.42), "Foot": (0, 0, -0.41),
    "Toe": (0.16, 0, -0.08),
}  # fmt: skip
"""Meters: X is forward, Y is left, Z is up."""


def offset(name: str) -> tuple[float, float, float]:
    x, y, z = OFFSETS[name.removeprefix("Left").removeprefix("Right")]
    return x, -y if name.startswith("Right") else y, z


SKELETON = Skeleton(NAMES, ABOVE, np.array([offset(name) for name in NAMES]))
ROTATIONS = swaying_rotations(20, len(NAMES))
ROOTS = np.arange(20)[:, None] * [0.02, 0, 0] + np.array([0, 0, 0.9])
POSITIONS = forward_kinematics(SKELETON, ROTATIONS, local_translations(SKELETON, ROOTS))


def world_rotations() -> FloatArray:
    world = ROTATIONS.copy()
    for joint, parent in enumerate(ABOVE):
        if parent >= 0:
            world[:, joint] = multiply(world[:, parent], world[:, joint])
    return world


def numbers(values: FloatArray) -> str:
    return " ".join(f"{value:.6f}" for value in np.ravel(values))


def frame(kind: str, position: FloatArray, orientation: FloatArray | None) -> str:
    turned = "" if orientation is None else f"<orientation>{numbers(orientation)}</orientation>"
    return (
        f'<frame time="0" type="{kind}">{turned}\n<position>{numbers(position)}</position>\n'
        "<velocity>1 2 3</velocity></frame>\n"
    )


def mvnx(
    *,
    joints: bool = True,
    orientation: bool = True,
    identity: bool = True,
    rate: str = "60",
    more: str = "",
    head: str = "",
    names: Sequence[str] = NAMES,
) -> bytes:
    segments = "".join(
        f'<segment label="{name}" id="{number}"><points><point label="p"><pos_b>0 0 0</pos_b>'
        "</point></points></segment>"
        for number, name in enumerate(names, 1)
    )
    links = "".join(
        f'<joint label="j"><connector1>{upper}/j</connector1><connector2>{lower}/j</connector2>'
        "</joint>\n"
        for lower, upper in PARENTS.items()
    )
    rest = forward_kinematics(SKELETON, ROTATIONS[:1] * 0 + [1, 0, 0, 0], SKELETON.offsets[None])
    still = np.tile([1.0, 0, 0, 0], (len(NAMES), 1))
    frames = frame("identity", rest[0], still) if identity else ""
    frames += frame("tpose", rest[0], still)
    for position, turned in zip(POSITIONS, world_rotations(), strict=True):
        frames += frame("normal", position, turned if orientation else None)
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n{head}<mvnx xmlns="http://www.xsens.com/mvn/mvnx"'
        f' version="4"><mvn version="2022"/><comment/><subject label="Ada" frameRate="{rate}"'
        f' segmentCount="{len(names)}"><segments>{segments}</segments>'
        + (f"<joints>{links}</joints>" if joints else "")
        + f"<frames>{frames}</frames></subject>{more}</mvnx>"
    ).encode()


@pytest.mark.parametrize("joints", [True, False])
@pytest.mark.parametrize("identity", [True, False])
def test_a_person_is_read_as_it_was_written(joints: bool, identity: bool) -> None:
    recording = read_recording(mvnx(joints=joints, identity=identity))
    assert (recording.format, recording.frame_rate, recording.up_axis) == ("mvnx", 60, "z")
    assert recording.cautions == ()
    order = [NAMES.index(name) for name in recording.skeleton.names]
    assert np.allclose(recording.positions, POSITIONS[:, order], atol=1e-5)
    assert recording.rotations is not None
    assert recording.translations is not None
    again = forward_kinematics(recording.skeleton, recording.rotations, recording.translations)
    assert np.allclose(again, recording.positions, atol=1e-5)
    if identity:
        assert np.allclose(recording.skeleton.offsets, SKELETON.offsets[order], atol=1e-5)
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert motion.names[motion.roles[R.LEFT_KNEE]] == "LeftLowerLeg"
    assert motion.names[motion.roles[R.RIGHT_SHOULDER]] == "RightUpperArm"


def test_positions_alone_are_enough() -> None:
    recording = read_mvnx(mvnx(orientation=False))
    assert recording.rotations is None
    assert canonicalize(recording).missing_roles == ()


def test_the_format_is_recognized_after_comments() -> None:
    head = '<!-- <!DOCTYPE mvnx SYSTEM "x"> -->\n'
    assert sniff(mvnx(head=head)) == "mvnx"
    doctype = '<!DOCTYPE mvnx SYSTEM "http://www.xsens.com/mvn/mvnx/schema.dtd">\n'
    assert np.array_equal(read_mvnx(mvnx(head=doctype)).positions, read_mvnx(mvnx()).positions)


def test_other_subjects_are_named() -> None:
    recording = read_mvnx(mvnx(more='<subject label="Bob" frameRate="240"><frames/></subject>'))
    assert (recording.frame_rate, recording.cautions[0].code) == (60, "several_subjects")
    assert "Bob" in recording.cautions[0].detail


def test_entities_are_refused() -> None:
    bomb = '<!DOCTYPE mvnx [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;">]>'
    other = '<!DOCTYPE mvnx [<!ENTITY a SYSTEM "file:///etc/passwd">]>'
    for head in (bomb, other):
        with cpu_seconds_below(1.0), pytest.raises(Unreadable, match="entities"):
            read_mvnx(mvnx(head=head))


@pytest.mark.parametrize(
    ("damage", "match"),
    [
        ((b"</frames>", b"</frame>"), "expected XML"),
        ((b"UTF-8", b"UTF-77"), "expected XML"),
        ((b'type="normal"', b'type="tpose"'), "type normal"),
        ((b"<segment ", b"<part "), "expected XML"),
        ((b"0.900000", b"nan"), "within"),
        ((b"0.900000", b"0.9 0.9"), "numbers, found"),
        ((b"0.900000", b"up"), "expected a number"),
        ((b"<connector1>Pelvis/", b"<connector1>LeftToe/"), "ancestor"),
    ],
)
def test_the_error_says_what_is_wrong(damage: tuple[bytes, bytes], match: str) -> None:
    content = mvnx().replace(*damage)
    assert content != mvnx()
    with pytest.raises(Unreadable, match=match):
        read_mvnx(content)


def test_deep_files_are_refused_quickly() -> None:
    with cpu_seconds_below(1.0), pytest.raises(Unreadable, match="levels"):
        read_mvnx(b"<mvnx>" + b"<a>" * 100_000)
    with cpu_seconds_below(1.0), pytest.raises(Unreadable, match="characters"):
        read_mvnx(mvnx().replace(b"<position>", b"<position>" + b"1 " * 200_000, 1))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(-1e6, 1e6), min_size=6, max_size=6))
def test_every_number_is_read(values: list[float]) -> None:
    text = " ".join(repr(value) for value in values)
    segments = '<segment label="a"/><segment label="b"/>'
    content = (
        f"<mvnx><subject><segments>{segments}</segments><frames><frame><position>{text}"
        "</position></frame></frames></subject></mvnx>"
    )
    expected = np.array(values, dtype=np.float32).reshape(1, 2, 3)
    assert np.array_equal(read_mvnx(content.encode()).positions, expected)


SMALL = mvnx()[:9000] + mvnx()[-6000:]


def read_broken(seed: int) -> Recording:
    content = mvnx() if seed % 2 else SMALL
    pieces = (*mutations.PIECES, b"<", b">", b"</frame>", b'"', b"&amp;", b"<![CDATA[")
    return read_mvnx(mutations.mutated(content, seed, pieces))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 20 < mutations.check_broken(read_broken, range(400)) < 390


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))
