"""Syntheses from demo clips: the motion, its quality, its storage, and refused queries."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_shape import motion_shape
from app.demo import demo_clips
from app.errors import BadField, ClipNotFound, ModelNotFitted, NotEnoughLabels, NotFound
from app.formats.read import read_recording
from app.models.synthesis.agreement import MIN_AGREEMENT
from app.models.synthesis.body import embody
from app.models.synthesis.motion import course_of
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import ANALYSIS_RATE, body_track, smooth_track
from app.motion.frame.foot_contact import FEET, skating
from app.motion.motion import Motion
from app.motion.posing.canonical_body import canonical_body
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import animation_of_positions
from app.services.clips import catalogue as clips
from app.services.clips import persons
from app.services.library.fitted_models import ModelKind
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.library.synthesized import SYNTHESIZED, is_synthesized
from app.services.synthesis.donors import donor_of
from app.services.synthesis.plan import SynthesisKind
from app.services.synthesis.synthesize import SynthesisQuery, synthesize
from app.services.training import models
from app.services.training.fit import fit_library
from app.services.training.training_set import read_training_set
from app.store.clips.record import ClipRecord, ClipState
from tests.libraries import settings_for, upload, work

ACTORS, TASKS = ("ada", "bruno", "chika"), ("walk", "wave", "bow", "dance")
LACKING = [("chika", "walk"), ("bruno", "wave"), ("bruno", "dance")]


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """Nine clips; chika has no walk, bruno has no wave and no dance. Tests must not change it."""
    lib = Library.open(settings_for(tmp_path_factory.mktemp("made"), analysis_processes=2))
    for clip in demo_clips(ACTORS, TASKS, takes=1):
        if (clip.person, clip.task) not in LACKING:
            upload(lib, clip, license="CC0-1.0")
    models.request_fit(lib)
    work(lib.settings)
    yield lib
    lib.close()


@pytest.fixture
def mine(fitted: Library, tmp_path: Path) -> Iterator[Library]:
    """A copy that a test may change."""
    shutil.copytree(fitted.settings.data_dir, tmp_path / "data")
    lib = Library.open(settings_for(tmp_path))
    yield lib
    lib.close()


def clip_of(lib: Library, person: str, task: str) -> ClipRecord:
    found = clips.list_clips(lib, limit=100).items
    return next(c for c in found if (c.person, c.task) == (person, task))


def test_a_known_person_gets_a_task_that_they_never_recorded(fitted: Library) -> None:
    made = synthesize(fitted, SynthesisQuery("walk", person="chika"))
    quality = made.quality
    assert quality.kind is SynthesisKind.NEW_TASK
    assert quality.given_persons == ("ada", "bruno")
    assert set(quality.given_tasks) == {"bow", "dance", "wave"}
    assert quality.task_is_right
    assert quality.nearest_task == "walk"
    assert quality.nearest is not None
    assert quality.person_is_right is False  # there is no walk of hers to be near to
    assert quality.expected_hit is None or 0 <= quality.expected_hit <= 1
    assert quality.real_skate is not None
    assert quality.skate < 2 * quality.real_skate + 0.1
    assert made.cycles >= 2
    assert made.license == "CC0-1.0"
    travelled = np.ptp(made.motion.role_positions()[:, 4], axis=0)
    assert max(travelled[0], travelled[2]) > 1.0


def test_the_bvh_file_has_the_motion_on_the_persons_own_skeleton(fitted: Library) -> None:
    made = synthesize(fitted, SynthesisQuery("walk", person="chika"))
    recording = read_recording(made.bvh)
    own = clip_of(fitted, "chika", "bow")
    theirs = read_recording(clips.open_file(fitted, own.id).path.read_bytes())
    assert recording.skeleton.names == theirs.skeleton.names
    bones = [np.linalg.norm(r.skeleton.offsets[1:], axis=1) for r in (recording, theirs)]
    np.testing.assert_allclose(bones[0], bones[1] * (bones[0].sum() / bones[1].sum()), atol=0.05)
    motion = canonicalize(recording, metres_per_unit=0.01)
    np.testing.assert_allclose(motion.positions, made.motion.positions, atol=2e-3)


def test_a_synthesized_walk_has_as_little_foot_skate_as_a_real_one(fitted: Library) -> None:
    made = synthesize(fitted, SynthesisQuery("walk", person="chika")).motion
    real = load_motion(fitted, clip_of(fitted, "ada", "walk"))
    lowest = made.positions[:, :, 1].min(axis=1)
    assert lowest.min() > -1e-3
    assert np.median(lowest) < 5e-3
    assert toe_speed(real) < 0.05  # meters per second
    assert toe_speed(made) < 0.15


def toe_speed(motion: Motion) -> float:
    """Median horizontal speed of the lower of the two toes, m/s."""
    toes = motion.positions[
        :, [motion.roles[r] for r in (JointRole.LEFT_TOES, JointRole.RIGHT_TOES)]
    ]
    speeds = np.linalg.norm(np.gradient(toes[:, :, [0, 2]], axis=0), axis=-1) * motion.frame_rate
    lower = toes[:, :, 1].argmin(axis=1)
    return float(np.median(speeds[np.arange(len(toes)), lower]))


def test_a_recorded_task_is_allowed_and_reported_as_seen(fitted: Library) -> None:
    made = synthesize(fitted, SynthesisQuery("wave", person="ada"))
    assert made.quality.kind is SynthesisKind.SEEN
    assert made.quality.expected_hit is None
    assert (made.quality.nearest_person, made.quality.nearest_task) == ("ada", "wave")
    assert made.cycles == 0


def test_if_dances_do_not_agree_one_is_followed_and_reported(fitted: Library) -> None:
    made = synthesize(fitted, SynthesisQuery("dance", person="bruno"))
    quality = made.quality
    assert quality.kind is SynthesisKind.NEW_TASK
    assert quality.given_persons == ("ada", "chika")
    assert quality.follows in {"ada", "chika"}
    assert quality.agreement is not None
    assert quality.agreement < MIN_AGREEMENT
    assert (quality.nearest_person, quality.nearest_task) == (quality.follows, "dance")
    real = load_motion(fitted, clip_of(fitted, quality.follows, "dance"))
    active = active_part(smooth_track(real))
    assert made.motion.duration == pytest.approx(active.duration, rel=0.05)
    assert jumps(made.motion) < 1.5 * jumps(real)
    walk = synthesize(fitted, SynthesisQuery("walk", person="chika")).quality
    assert walk.follows is None
    assert walk.agreement is not None
    assert walk.agreement > MIN_AGREEMENT


def jumps(motion: Motion) -> float:
    """Largest change of velocity of a joint role within a thirtieth of a second, m/s."""
    bends = np.diff(body_track(motion).positions, 2, axis=0)
    return float(np.linalg.norm(bends, axis=-1).max() * ANALYSIS_RATE)


def test_the_person_of_some_clips_can_get_all_tasks(fitted: Library) -> None:
    ids = tuple(clip_of(fitted, "chika", task).id for task in ("bow", "dance", "wave"))
    made = synthesize(fitted, SynthesisQuery("walk", clip_ids=ids))
    assert made.quality.kind is SynthesisKind.NEW_PERSON
    assert made.person == "chika"
    assert set(made.quality.given_tasks) == {"bow", "dance", "wave"}
    assert made.quality.given_persons == ("ada", "bruno")
    known = synthesize(fitted, SynthesisQuery("walk", person="chika"))
    np.testing.assert_allclose(made.motion.positions, known.motion.positions, atol=0.05)


def test_only_the_given_clips_of_the_person_are_used(fitted: Library) -> None:
    made = synthesize(fitted, SynthesisQuery("bow", clip_ids=(clip_of(fitted, "ada", "walk").id,)))
    assert made.quality.kind is SynthesisKind.NEW_PERSON
    assert made.quality.given_persons == ("bruno", "chika")


def test_a_clip_that_is_named_twice_counts_once(fitted: Library) -> None:
    walk = clip_of(fitted, "ada", "walk").id
    once, twice = (
        synthesize(fitted, SynthesisQuery("bow", clip_ids=ids)) for ids in ((walk,), (walk, walk))
    )
    np.testing.assert_array_equal(once.motion.positions, twice.motion.positions)
    assert once.quality == twice.quality


def test_a_synthesis_has_the_requested_duration_and_is_reproducible(fitted: Library) -> None:
    query = SynthesisQuery("walk", person="chika", seconds=7.0)
    made, again = synthesize(fitted, query), synthesize(fitted, query)
    assert made.motion.duration == pytest.approx(7.0, abs=0.8)
    assert made.bvh == again.bvh
    stretched = synthesize(fitted, SynthesisQuery("bow", person="ada", seconds=3.0))
    assert stretched.motion.duration == pytest.approx(3.0, abs=0.05)


def test_a_stored_synthesis_is_a_clip_that_no_model_learns_from(mine: Library) -> None:
    query = SynthesisQuery("walk", person="chika", store=True)
    made = synthesize(mine, query)
    assert made.clip is not None
    assert made.job is not None
    again = synthesize(mine, query)
    assert again.clip is not None
    assert (again.clip.id, again.is_new) == (made.clip.id, False)
    work(mine.settings)
    clip = clips.get_clip(mine, made.clip.id)
    assert clip.state is ClipState.READY, clip.error
    assert (clip.person, clip.task, clip.source) == ("chika", "walk", SYNTHESIZED)
    assert clip.frames == made.motion.frames
    assert is_synthesized(clip)
    assert "chika" not in clip.name + clip.file_name  # who must be forgotten on request
    assert clip.id not in {c.id for c in read_training_set(mine.store).clips}
    assert synthesize(mine, query).quality.kind is SynthesisKind.NEW_TASK


def test_an_impossible_synthesis_is_refused_with_its_reason(fitted: Library) -> None:
    with pytest.raises(NotFound, match=r"person 'nobody'.*ada"):
        synthesize(fitted, SynthesisQuery("walk", person="nobody"))
    with pytest.raises(NotFound, match="task 'fly'"):
        synthesize(fitted, SynthesisQuery("fly", person="ada"))
    with pytest.raises(ClipNotFound):
        synthesize(fitted, SynthesisQuery("walk", clip_ids=("clip_nowhere",)))
    with pytest.raises(NotEnoughLabels, match="another task"):
        synthesize(fitted, SynthesisQuery("bow", clip_ids=(clip_of(fitted, "ada", "bow").id,)))
    both = tuple(clip_of(fitted, person, "bow").id for person in ("ada", "bruno"))
    with pytest.raises(BadField, match="one person"):
        synthesize(fitted, SynthesisQuery("walk", clip_ids=both))
    for query in (
        SynthesisQuery("walk"),
        SynthesisQuery("  ", person="ada"),
        SynthesisQuery("walk", person="ada", clip_ids=both),
        SynthesisQuery("walk", clip_ids=()),
        SynthesisQuery("walk", person="ada", seconds=0.1),
    ):
        with pytest.raises(BadField):
            synthesize(fitted, query)


def test_a_person_who_is_forgotten_is_in_no_synthesis(mine: Library) -> None:
    assert synthesize(mine, SynthesisQuery("walk", person="chika")).person == "chika"
    persons.forget_person(mine, "chika")
    with pytest.raises(ModelNotFitted):
        synthesize(mine, SynthesisQuery("walk", person="chika"))
    fit_library(mine.store)
    with pytest.raises(NotFound):
        synthesize(mine, SynthesisQuery("walk", person="chika"))
    fitted = mine.models.synthesis(mine.store).model
    assert fitted.persons == ("ada", "bruno")
    assert synthesize(mine, SynthesisQuery("wave", person="bruno")).person == "bruno"


def test_there_is_no_synthesis_if_recognizing_persons_is_switched_off(mine: Library) -> None:
    closed = replace(mine, settings=settings_for(Path("/nowhere"), recognize_persons=False))
    with pytest.raises(ModelNotFitted, match="KINEDEX_RECOGNIZE_PERSONS"):
        synthesize(closed, SynthesisQuery("walk", person="chika"))
    outcome = fit_library(mine.store, persons=False)["models"][ModelKind.SYNTHESIS.value]
    assert outcome["outcome"] == "skipped"
    assert "two persons" in outcome["reason"]


def test_the_synthesis_model_is_listed_with_held_out_figures(fitted: Library) -> None:
    record = next(m for m in models.list_models(fitted) if m.kind == ModelKind.SYNTHESIS)
    rows = record.meta["figures"]["held_out"]
    assert {"new_task", "new_person"} == set(rows)
    assert all(0 <= row["hit"] <= 1 for of_kind in rows.values() for row in of_kind)
    assert [row["given"] for row in rows["new_task"]] == [1, 2]


def test_clips_of_markers_give_a_persons_proportions_to_the_canonical_body(fitted: Library) -> None:
    clip = clip_of(fitted, "ada", "walk")
    motion = load_motion(fitted, clip)
    loose = replace(motion, parents=np.full(len(motion.names), -1))
    animation = animation_of_positions(loose.names, loose.parents, loose.positions, 30.0)
    donor = donor_of(loose, animation)
    assert donor.animation.skeleton.names == canonical_body().names
    assert donor.track.frames == len(donor.animation.rotations)
    course = course_of(motion_shape(donor.track), donor.track.body_length)
    made = embody(course, [donor]).positions()
    feet = made[:, [donor.joints[SUN_ROLES[foot]] for foot in FEET]]
    assert np.isfinite(made).all()
    assert skating(feet, 30.0) < 0.6
