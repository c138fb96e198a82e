"""Every recording gets one form: meters, Y up, with roles, frame rate and unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import BadContent, BadField, NotHuman, Unreadable
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Caution, Recording
from app.motion.skeleton.skeleton import Skeleton
from tests.people import CONVENTIONS, ROLES, person

R = JointRole


def without(recording: Recording, *parts: str) -> Recording:
    """The recording without the joints of roles with these endings."""
    keep = [i for i, role in enumerate(ROLES) if not role.endswith(parts)]
    renumber = {old: new for new, old in enumerate(keep)}
    skeleton = recording.skeleton
    parents = [renumber.get(int(skeleton.parents[i]), -1) for i in keep]
    smaller = replace(
        skeleton,
        names=tuple(skeleton.names[i] for i in keep),
        parents=np.array(parents),
        offsets=skeleton.offsets[keep],
    )
    return replace(recording, skeleton=smaller, positions=recording.positions[:, keep])


def test_a_person_in_centimetres_and_z_up() -> None:
    plain = person(CONVENTIONS["DAZ"])
    lying_axes = plain.positions[..., [0, 2, 1]] * np.array([100, -100, 100], dtype=np.float32)
    offsets = plain.skeleton.offsets[:, [0, 2, 1]] * np.array([100, -100, 100])
    skeleton = replace(plain.skeleton, offsets=offsets)
    motion = canonicalize(replace(plain, positions=lying_axes, skeleton=skeleton))
    assert motion.metres_per_unit == 0.01
    assert np.allclose(motion.positions, plain.positions, atol=1e-5)
    assert motion.positions.dtype == np.float32
    assert [caution.code for caution in motion.cautions] == ["up_axis_guessed"]
    assert motion.missing_roles == ()


def test_hints_of_the_client_have_priority() -> None:
    motion = canonicalize(
        person(CONVENTIONS["DAZ"]),
        frame_rate=60,
        metres_per_unit=2.0,
        roles={R.HEAD: "neck", R.NECK: "chest"},
    )
    assert (motion.frame_rate, motion.declared_frame_rate) == (60, 30)
    assert motion.metres_per_unit == 2.0
    assert motion.names[motion.roles[R.HEAD]] == "neck"


@pytest.mark.parametrize("value", [0, -1, float("nan"), float("inf"), 1e9])
def test_impossible_hints_are_refused(value: float) -> None:
    for field in ("frame_rate", "metres_per_unit"):
        with pytest.raises(BadField) as caught:
            canonicalize(person(), **{field: value})
        assert caught.value.places


def test_an_unknown_role_is_refused() -> None:
    with pytest.raises(BadField):
        canonicalize(person(), roles={"tail": "j0"})


def test_a_missing_frame_rate_is_refused_without_a_hint() -> None:
    silent = person(frame_rate=None)
    doubt = Caution("frame_time_unusable", "line 9: expected a frame time in seconds, found '0'")
    with pytest.raises(Unreadable, match="line 9"):
        canonicalize(replace(silent, cautions=(doubt,)))
    assert canonicalize(silent, frame_rate=25).frame_rate == 25


@pytest.mark.parametrize("rate", [0.01, 0.99, 2001.0, 1e9])
def test_an_impossible_frame_rate_of_the_file_is_refused(rate: float) -> None:
    with pytest.raises(Unreadable, match="1 to 2000 Hz") as caught:
        canonicalize(person(frame_rate=rate))
    assert caught.value.places[0].location == "frame_rate"
    assert canonicalize(person(frame_rate=rate), frame_rate=25).frame_rate == 25


def test_a_body_without_arms_is_accepted_with_a_caution() -> None:
    armless = without(person(CONVENTIONS["MotionBuilder"]), "shoulder", "elbow", "hand")
    motion = canonicalize(armless)
    missing = {role for role in SUN_ROLES if role.endswith(("shoulder", "elbow", "hand"))}
    assert set(motion.missing_roles) == missing
    assert "roles_missing" in [caution.code for caution in motion.cautions]
    assert motion.role_positions().shape == (40, 13, 3)


@pytest.mark.parametrize(
    ("parts", "missing"),
    [
        (("leg", "knee", "foot", "toes", "elbow", "hand"), "left_knee, right_knee"),
        (("neck", "head", "chest", "shoulder", "elbow", "hand", "foot", "toes"), "neck"),
        (("left_knee", "left_foot", "left_toes"), "left_knee"),
    ],
)
def test_a_body_with_less_than_a_half_is_refused(parts: tuple[str, ...], missing: str) -> None:
    less = without(person(CONVENTIONS["MotionBuilder"]), *parts)
    with pytest.raises(NotHuman, match=missing):
        canonicalize(less)


NAMES = sorted({name for names in CONVENTIONS.values() for name in names.values()})


@settings(max_examples=100, deadline=None)
@given(data=st.data(), frames=st.integers(1, 40), size=st.sampled_from([0.0, 1e-20, 1.0, 1e8]))
def test_strange_skeletons_give_a_motion_or_our_own_error(
    data: st.DataObject, frames: int, size: float
) -> None:
    names = data.draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=30))
    parents = [data.draw(st.integers(-1, joint - 1)) for joint in range(len(names))]
    rng = np.random.default_rng(data.draw(st.integers(0, 1000)))
    recording = Recording(
        format="bvh",
        skeleton=Skeleton(tuple(names), np.array(parents), size * rng.normal(size=(len(names), 3))),
        positions=(size * rng.normal(size=(frames, len(names), 3))).astype(np.float32),
        rotations=None,
        translations=None,
        frame_rate=data.draw(st.sampled_from([1.0, 30.0, 2000.0])),
    )
    try:
        motion = canonicalize(recording)
    except BadContent:
        return
    assert np.isfinite(motion.positions).all()
    assert len(set(motion.roles.values())) == len(motion.roles)
    assert motion.role_positions().shape == (frames, 13, 3)


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_the_shortest_clips(frames: int) -> None:
    motion = canonicalize(person(CONVENTIONS["SMPL"], frames=frames))
    assert motion.frames == frames
    assert np.isfinite(motion.positions).all()


def test_one_of_two_people_is_used_with_a_caution() -> None:
    one, other = person(), person(seed=1)
    skeleton = one.skeleton
    count = len(skeleton)
    both = replace(
        one,
        skeleton=Skeleton(
            names=(*skeleton.names, *(f"Second_{name}" for name in skeleton.names)),
            parents=np.concatenate(
                [skeleton.parents, np.where(skeleton.parents < 0, -1, skeleton.parents + count)]
            ),
            offsets=np.concatenate([skeleton.offsets, skeleton.offsets]),
        ),
        positions=np.concatenate([one.positions, other.positions + np.float32(1)], axis=1),
    )
    motion = canonicalize(both)
    assert "several_people" in [caution.code for caution in motion.cautions]
    same_tree = {joint < count for joint in motion.roles.values()}
    assert len(same_tree) == 1


def test_a_prop_is_not_a_second_person() -> None:
    body = person()
    names = (*body.skeleton.names, *(f"rope{i}" for i in range(12)))
    parents = [*body.skeleton.parents.tolist(), -1, *range(len(body.skeleton), len(names) - 1)]
    rope = np.zeros((len(body.positions), 12, 3), dtype=np.float32)
    rope[..., 0] = np.arange(12) * 0.2
    prop = replace(
        body,
        skeleton=Skeleton(names, np.array(parents), np.zeros((len(names), 3))),
        positions=np.concatenate([body.positions, rope], axis=1),
    )
    assert "several_people" not in [caution.code for caution in canonicalize(prop).cautions]
