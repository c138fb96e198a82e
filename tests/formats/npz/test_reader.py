"""NPZ and NPY files are read correctly, or refused with the key, frame or joint."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from app.errors import FormatNotSupported, NotHuman, TooLarge, Unreadable
from app.formats.npz.reader import read_npz
from app.formats.npz.writer import write_npz
from app.formats.read import read_recording
from app.kinedex_error import KinedexError
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES
from tests.cpu_time import cpu_seconds_below
from tests.formats.npz.files import a_person, npy, npz, person_arrays, zipped

PERSON = a_person()
ARRAYS = person_arrays(PERSON)


def place_of(content: bytes) -> tuple[str, str]:
    with pytest.raises(Unreadable) as caught:
        read_recording(content)
    (place,) = caught.value.places
    assert "expected" in place.message
    return place.location, place.message


def test_the_documented_layout() -> None:
    recording = read_recording(npz(**ARRAYS))
    assert recording.format == "npz"
    assert recording.skeleton.names == PERSON.skeleton.names
    assert recording.skeleton.parents.tolist() == PERSON.skeleton.parents.tolist()
    assert recording.frame_rate == 30.0
    assert recording.metres_per_unit == 1.0
    assert recording.up_axis == "y"
    assert recording.rotations is None
    assert recording.cautions == ()
    np.testing.assert_array_equal(recording.positions, PERSON.positions)
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert motion.roles == canonicalize(PERSON).roles


@pytest.mark.parametrize(
    "changed",
    [
        {"joints": "positions", "names": "joint_names", "fps": "frame_rate"},
        {"Joint_Positions": "positions", "mocap_framerate": "frame_rate", "units": "unit"},
        {"keypoints3d": "positions", "JOINTS": "joint_names", "kintree_table": "parents"},
        {"xyz": "positions", "markers": "joint_names"},
    ],
)
def test_other_names_of_the_keys(changed: dict[str, str]) -> None:
    arrays = {key: value for key, value in ARRAYS.items() if key not in changed.values()}
    arrays |= {new: ARRAYS[old] for new, old in changed.items()}
    recording = read_npz(npz(compressed=True, **arrays))
    assert recording.skeleton.names == PERSON.skeleton.names
    assert recording.frame_rate == 30.0
    np.testing.assert_array_equal(recording.positions, PERSON.positions)


@pytest.mark.parametrize(
    "positions",
    [
        PERSON.positions.astype(">f8"),
        PERSON.positions.astype("<f2"),
        np.asfortranarray(PERSON.positions),
        (PERSON.positions * 1000).astype(np.int16),
        (PERSON.positions * 1000 + 5000).astype(np.uint32),
    ],
)
def test_any_kind_of_numbers_and_order(positions: np.ndarray) -> None:
    recording = read_npz(npz(**ARRAYS | {"positions": positions}))
    assert recording.positions.dtype == np.float32
    assert recording.positions.flags.c_contiguous
    np.testing.assert_array_equal(recording.positions, positions.astype(np.float32))


def test_joints_come_after_their_parents() -> None:
    order = np.random.default_rng(5).permutation(len(PERSON.skeleton))
    new_index = np.argsort(order)
    parents = PERSON.skeleton.parents[order]
    shuffled = {
        "positions": PERSON.positions[:, order],
        "joint_names": ARRAYS["joint_names"][order],
        "parents": np.where(parents >= 0, new_index[parents], -1),
    }
    recording = read_npz(npz(**ARRAYS | shuffled))
    skeleton = recording.skeleton
    assert all(parent < joint for joint, parent in enumerate(skeleton.parents))
    for joint, name in enumerate(skeleton.names):
        there = PERSON.skeleton.names.index(name)
        np.testing.assert_array_equal(recording.positions[:, joint], PERSON.positions[:, there])
    assert canonicalize(recording).missing_roles == ()


def test_roles_are_found_by_names_without_parents() -> None:
    recording = read_npz(npz(**{k: v for k, v in ARRAYS.items() if k != "parents"}))
    assert set(recording.skeleton.parents.tolist()) == {-1}
    assert set(canonicalize(recording).roles) >= set(SUN_ROLES)


def test_a_root_has_the_parent_minus_one_or_itself_or_that_of_smpl() -> None:
    parents = PERSON.skeleton.parents
    table = np.stack([parents, np.arange(len(parents))]).astype(np.uint32)
    itself = np.where(parents < 0, np.arange(len(parents)), parents)
    for written_parents in (parents.astype(np.int8), itself, table):
        recording = read_npz(npz(**ARRAYS | {"parents": written_parents}))
        assert recording.skeleton.parents.tolist() == parents.tolist()


def test_z_up_centimeters_become_y_up_meters() -> None:
    x, y, z = np.moveaxis(PERSON.positions, -1, 0)
    turned = {"positions": 100 * np.stack([x, -z, y], axis=-1), "unit": "cm", "up_axis": "Z"}
    motion = canonicalize(read_npz(npz(**ARRAYS | turned)))
    np.testing.assert_allclose(motion.positions, PERSON.positions, atol=1e-5)


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "no joints axis": ({"positions": np.zeros((5, 54))}, "positions"),
    "quaternions": ({"positions": np.zeros((5, 18, 4))}, "positions"),
    "text for positions": ({"positions": np.array(["a"])}, "positions"),
    "truth for positions": ({"positions": np.zeros((5, 18, 3), dtype=bool)}, "positions"),
    "too few names": ({"joint_names": ARRAYS["joint_names"][1:]}, "joint_names"),
    "numbers for names": ({"joint_names": np.arange(18)}, "joint_names"),
    "an empty name": ({"joint_names": np.array(["Hips", "", *"abcdefghijklmnop"])}, "joint 1"),
    "a name that rings": ({"joint_names": np.array(["\a", *"abcdefghijklmnopq"])}, "joint 0"),
    "names without end": ({"joint_names": np.array(["x" * 99_999] * 18)}, "joint_names"),
    "too few parents": ({"parents": np.zeros(3, dtype=int)}, "parents"),
    "parts of parents": ({"parents": np.full(18, 0.5)}, "parents"),
    "a parent that is none": ({"parents": np.array([-1] * 17 + [18])}, "joint 17 (RightToeBase)"),
    "a circle": ({"parents": np.array([-1, 2, 1] + [0] * 15)}, "joint 1 (Spine1)"),
    "two rates": ({"frame_rate": np.array([30.0, 60.0])}, "frame_rate"),
    "rate 0": ({"frame_rate": 0.0}, "frame_rate"),
    "rate nan": ({"frame_rate": np.nan}, "frame_rate"),
    "rate in words": ({"frame_rate": "fast"}, "frame_rate"),
    "an unknown unit": ({"unit": "furlong"}, "unit"),
    "a unit of nothing": ({"unit": 0.0}, "unit"),
    "an unknown axis": ({"up_axis": "w"}, "up_axis"),
    "numbers for an axis": ({"up_axis": 2}, "up_axis"),
}


@pytest.mark.parametrize("name", WRONG)
def test_the_error_names_the_key_frame_or_joint(name: str) -> None:
    changes, location = WRONG[name]
    assert place_of(npz(**ARRAYS | changes))[0] == location


@pytest.mark.parametrize("bad", [np.inf, -np.inf, 1e12])
def test_infinite_and_large_numbers_are_refused_with_frame_and_joint(bad: float) -> None:
    positions = PERSON.positions.copy()
    positions[7, 3, 2] = bad
    location, message = place_of(npz(**ARRAYS | {"positions": positions}))
    assert location == "frame 7, joint 3"
    assert "positions[7, 3, 2]" in message


def test_joints_hidden_for_a_short_time_are_filled_in() -> None:
    positions = PERSON.positions.copy()
    positions[7:9, 3, 2] = np.nan
    arrays = ARRAYS | {"positions": positions}
    recording = read_recording(npz(**arrays))
    assert [c.code for c in recording.cautions] == ["gaps_filled"]
    (caution,) = recording.cautions
    assert (caution.frames, caution.joint) == ((7, 9), recording.skeleton.names[3])
    assert "frames 7 to 8" in caution.detail
    assert np.abs(recording.positions - PERSON.positions).max() < 0.01
    assert np.isfinite(read_recording(npy(positions)).positions).all()


@pytest.mark.parametrize("sentinel", [9999.99, -9999.0, 1e6])
def test_large_equal_numbers_stand_for_hidden_joints(sentinel: float) -> None:
    positions = PERSON.positions.copy()
    positions[7:9, 3] = sentinel
    recording = read_recording(npz(**ARRAYS | {"positions": positions}))
    assert [c.code for c in recording.cautions] == ["gaps_filled"]
    assert np.abs(recording.positions - PERSON.positions).max() < 0.01


def test_joints_hidden_for_a_long_time_are_named() -> None:
    positions = PERSON.positions.copy()
    positions[2:-1, 3] = np.nan
    location, message = place_of(npz(**ARRAYS | {"positions": positions}))
    assert location.startswith("frame 2, joint 3 (")
    assert str(len(positions) - 3) in message
    with pytest.raises(Unreadable, match="hidden for too long"):
        read_recording(npy(np.full_like(positions, np.nan)))


@pytest.mark.parametrize(("first", "last"), [(0, 20), (20, 40)])
def test_the_longest_stretch_without_hidden_joints_is_read(first: int, last: int) -> None:
    positions = PERSON.positions.copy()
    positions[first:last, 3] = np.nan
    recording = read_recording(npz(**ARRAYS | {"positions": positions}))
    start = last if first == 0 else 0
    assert [c.code for c in recording.cautions] == ["frames_trimmed"]
    assert f"frames {start} to {start + 19}" in recording.cautions[0].detail
    assert recording.start_frame == start
    assert np.array_equal(recording.positions, PERSON.positions[start : start + 20])


@pytest.mark.parametrize("key", ["arr_0", "posed_joints", "points"])
def test_other_names_of_positions(key: str) -> None:
    recording = read_recording(npz(**{key: PERSON.positions}))
    assert np.array_equal(recording.positions, PERSON.positions)


def test_poses_beside_markers_are_the_motion() -> None:
    rng = np.random.default_rng(0)
    arrays = {
        "poses": rng.normal(scale=0.1, size=(20, 66)), "trans": np.zeros((20, 3)),
        "markers": rng.normal(size=(20, 40, 3)), "labels": np.array([f"M{n}" for n in range(40)]),
        "mocap_framerate": np.array(60.0),
    }  # fmt: skip
    assert len(read_recording(npz(**arrays)).skeleton) == 24
    del arrays["poses"]
    assert len(read_recording(npz(**arrays)).skeleton) == 40


def test_the_error_for_another_archive_names_its_arrays() -> None:
    with pytest.raises(FormatNotSupported) as caught:
        read_recording(npz(weights=np.zeros(3), bias=np.zeros(3)))
    (place,) = caught.value.places
    assert place.location == "positions"
    assert "weights.npy, bias.npy" in place.message
    assert place_of(npz(fps=30.0, bias=np.zeros(3))) == (
        "positions",
        "expected an array of positions, or of SMPL poses; found fps, bias",
    )


def test_very_large_arrays_are_refused() -> None:
    for shape in ((1, 2001, 3), (100_000, 201, 3)):
        content = npz(positions=np.zeros(shape, dtype=np.int8))
        with pytest.raises(TooLarge):
            read_npz(content)


def test_an_array_without_a_known_order_accepts_roles_of_the_client() -> None:
    recording = read_recording(npy(PERSON.positions))
    assert recording.format == "npy"
    assert recording.frame_rate is None
    assert [c.code for c in recording.cautions] == ["joint_names_missing"]
    with pytest.raises(NotHuman) as refused:
        canonicalize(recording, frame_rate=30.0)
    assert refused.value.places[0].location == "roles.hips"
    roles = canonicalize(PERSON).roles
    sent = {role.value: f"joint_{joint}" for role, joint in roles.items()}
    motion = canonicalize(recording, frame_rate=30.0, roles=sent)
    assert motion.roles == roles


def test_an_array_alone_must_be_positions() -> None:
    assert place_of(npy(np.zeros((10, 263))))[0] == "array"
    assert place_of(npy(np.zeros((10, 3, 24))))[0] == "array"


names_and_parents = st.integers(1, 9).flatmap(
    lambda joints: st.tuples(
        st.lists(
            st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=9),
            min_size=joints, max_size=joints,
        ),
        st.tuples(*(st.integers(-1, joint - 1) for joint in range(joints))),
    )
)  # fmt: skip


@settings(max_examples=80, deadline=None)
@given(skeleton=names_and_parents, frames=st.integers(1, 6), data=st.data())
def test_a_written_file_is_read_back(
    skeleton: tuple[list[str], tuple[int, ...]], frames: int, data: st.DataObject
) -> None:
    names, parents = skeleton
    shape = (frames, len(names), 3)
    # Larger numbers may stand for joints that were not seen.
    numbers = st.floats(-800, 800, width=32)
    positions = data.draw(hnp.arrays(np.float32, shape, elements=numbers))
    rate = data.draw(st.floats(0.1, 2000.0))
    content = write_npz(names, np.array(parents), positions, rate)
    assert content == write_npz(names, np.array(parents), positions, rate)
    recording = read_npz(content)
    assert recording.skeleton.names == tuple(names)
    assert recording.skeleton.parents.tolist() == list(parents)
    assert recording.frame_rate == rate
    np.testing.assert_array_equal(recording.positions, positions)


def mutated(rng: np.random.Generator, content: bytes) -> bytes:
    """A few bytes changed, cut out, or doubled."""
    result = bytearray(content)
    for _ in range(int(rng.integers(1, 5))):
        start = int(rng.integers(0, len(result) + 1))
        stop = start + int(rng.integers(0, 9))
        kind = rng.integers(0, 3)
        result[start:stop] = [rng.bytes(stop - start), b"", result[start:stop] * 2][kind]
    return bytes(result)


def with_a_mutated_member(rng: np.random.Generator, arrays: dict[str, Any]) -> bytes:
    members = {f"{key}.npy": npy(array) for key, array in arrays.items()}
    chosen = list(members)[rng.integers(0, len(members))]
    return zipped(members | {chosen: mutated(rng, members[chosen])})


def check_mutations(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    small = {k: v[:3] if k == "positions" else v for k, v in ARRAYS.items()}
    amass = {"poses": np.zeros((3, 72)), "trans": np.zeros((3, 3)), "mocap_framerate": 120.0}
    bases = [npz(**small), npz(compressed=True, **small), npz(**amass), npy(small["positions"])]
    for index in range(count):
        # Of whole files most mutants die by their checksum, so every other one is of a member.
        whole = mutated(rng, bases[index // 2 % len(bases)])
        content = whole if index % 2 else with_a_mutated_member(rng, (small, amass)[index // 2 % 2])
        with suppress(KinedexError), cpu_seconds_below(1.0, f"mutation {index}"):
            assert np.isfinite(read_recording(content).positions).all()


def test_damaged_files_raise_only_our_own_errors() -> None:
    check_mutations(400, seed=1)


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    check_mutations(10_000, seed=2)
