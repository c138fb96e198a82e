"""Edits of clips: the new clip has the edited motion, its origin and the labels."""

from __future__ import annotations

import io

import numpy as np
import pytest

from app.errors import BadField, ClipNotFound, TooShort
from app.motion.roles.joint_roles import JointRole
from app.services.clips import catalogue as clips
from app.services.clips import persons
from app.services.editing.edits import edit_clip
from app.services.editing.steps import EditKind, EditStep
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.training.training_set import read_training_set
from app.store.clips import keypose_annotations
from app.store.clips.record import ClipRecord, ClipState
from tests.formats.npz.files import npz
from tests.libraries import work

ROUNDING = 1e-4
"""Meters: six decimals of centimeters and degrees, along chains of joints."""
CUT = EditStep(EditKind.CUT, start=0.5, end=1.5)
MIRROR = EditStep(EditKind.MIRROR)


def clip_of(lib: Library, person: str, task: str) -> ClipRecord:
    found = clips.list_clips(lib, limit=100).items
    return next(clip for clip in found if (clip.person, clip.task) == (person, task))


def done(lib: Library, clip: ClipRecord, *steps: EditStep) -> ClipRecord:
    """The new clip, ready."""
    created = edit_clip(lib, clip.id, steps)
    assert created.is_new
    work(lib.settings)
    new = clips.get_clip(lib, created.clip.id)
    assert new.state is ClipState.READY, new.error
    return new


def test_a_cut_is_the_same_motion_to_rounding(mine: Library) -> None:
    clip = clip_of(mine, "ada", "walk")
    new = done(mine, clip, CUT)
    before, after = load_motion(mine, clip), load_motion(mine, new)
    first, stop = round(0.5 * before.frame_rate), round(1.5 * before.frame_rate)
    assert (after.names, after.frame_rate) == (before.names, pytest.approx(before.frame_rate))
    assert after.roles == before.roles
    assert np.abs(after.positions - before.positions[first:stop]).max() < ROUNDING
    assert new.origin is not None
    assert new.origin.clip_id == clip.id
    assert new.origin.steps == ({"kind": "cut", "start": 0.5, "end": 1.5},)
    assert new.name == f"{clip.name} (cut)"


def test_labels_are_carried_over_with_sides_exchanged(mine: Library) -> None:
    clip = clip_of(mine, "ada", "kick")
    clips.update_clip(mine, clip.id, {"task": "right kick", "words": ["kick", "right_leg"]})
    new = done(mine, clip, MIRROR)
    assert (new.person, new.task, new.words) == ("ada", "left kick", ("kick", "left_leg"))
    assert (new.license, new.source) == (clip.license, clip.source)
    before, after = load_motion(mine, clip), load_motion(mine, new)
    left, right = (before.roles[role] for role in (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT))
    heights = before.positions[:, [left, right], 1]
    assert np.abs(after.positions[:, [right, left], 1] - heights).max() < ROUNDING


def test_steps_are_done_one_after_the_other(mine: Library) -> None:
    clip = clip_of(mine, "ada", "walk")
    steps = (CUT, MIRROR, EditStep(EditKind.IN_PLACE), EditStep(EditKind.RESAMPLE, fps=25))
    new = done(mine, clip, *steps)
    assert new.frame_rate == pytest.approx(25)
    assert new.duration == pytest.approx(1.0, abs=0.05)
    hips = load_motion(mine, new).positions[:, load_motion(mine, new).roles[JointRole.HIPS]]
    assert np.ptp(hips[:, [0, 2]], axis=0).max() < ROUNDING
    assert new.origin is not None
    assert [step["kind"] for step in new.origin.steps] == ["cut", "mirror", "in_place", "resample"]


def test_a_loop_says_where_it_was_cut(mine: Library) -> None:
    new = done(mine, clip_of(mine, "ada", "walk"), EditStep(EditKind.LOOP, max_seconds=2.0))
    assert new.origin is not None
    (step,) = new.origin.steps
    assert step["end"] - step["start"] == pytest.approx(new.duration, abs=0.02)
    assert step["distance"] < 0.5


def test_the_same_edit_is_stored_once(mine: Library) -> None:
    clip = clip_of(mine, "ada", "walk")
    first, second = (edit_clip(mine, clip.id, [CUT]) for _ in range(2))
    assert first.clip.id == second.clip.id
    assert (first.is_new, second.is_new) == (True, False)


def test_a_clip_without_rotations_can_be_edited(mine: Library) -> None:
    walk = load_motion(mine, clip_of(mine, "ada", "walk"))
    content = npz(
        positions=walk.positions, joint_names=np.array(walk.names), frame_rate=walk.frame_rate
    )
    stored = clips.create_clip(mine, io.BytesIO(content), "walk.npz", {"task": "walk"}).clip
    work(mine.settings)
    clip = clips.get_clip(mine, stored.id)
    new = done(mine, clip, CUT)
    before, after = load_motion(mine, clip), load_motion(mine, new)
    first = round(0.5 * before.frame_rate)
    order = [after.names.index(name) for name in before.names]
    cut = before.positions[first : first + after.frames]
    assert np.abs(after.positions[:, order] - cut).max() < ROUNDING


def test_the_copy_outlives_the_original_and_says_so(mine: Library) -> None:
    clip = clip_of(mine, "ada", "walk")
    new = done(mine, clip, CUT)
    assert new.origin is not None
    assert not new.origin.is_deleted
    assert new.id not in {one.id for one in read_training_set(mine.store).clips}
    clips.delete_clip(mine, clip.id)
    after = clips.get_clip(mine, new.id)
    assert after.state is ClipState.READY
    assert after.origin is not None
    assert after.origin.is_deleted
    assert after.origin.clip_id == clip.id
    assert new.id in {one.id for one in read_training_set(mine.store).clips}


def test_a_forgotten_person_is_forgotten_in_copies_too(mine: Library) -> None:
    clip = clip_of(mine, "ada", "walk")
    clips.update_clip(mine, clip.id, {"name": "ada walks"})
    new = done(mine, clip, CUT)
    persons.forget_person(mine, "ada")
    after = clips.get_clip(mine, new.id)
    assert after.person is None
    assert "ada" not in after.name + after.file_name


def test_annotated_keyposes_and_beats_go_with_the_part(mine: Library) -> None:
    clip = clip_of(mine, "ada", "walk")
    clips.update_clip(mine, clip.id, {"beats": [0.25, 0.75, 1.25, 1.75]})
    with mine.store.write() as tx:
        keypose_annotations.put(tx, clip.id, [0.2, 1.0])
    work(mine.settings)
    new = edit_clip(mine, clip.id, [CUT]).clip
    assert new.hints.beats == (0.25, 0.75)
    with mine.store.read() as tx:
        assert keypose_annotations.get(tx, new.id) == (0.5,)


@pytest.mark.parametrize(
    ("step", "place"),
    [
        (EditStep(EditKind.MIRROR, start=1.0), "steps.0.start"),
        (EditStep(EditKind.CUT, start=1.0, end=1.0), "steps.0.end"),
        (EditStep(EditKind.CUT, start=1000.0), "steps.0.end"),
        (EditStep(EditKind.RESAMPLE), "steps.0.fps"),
        (EditStep(EditKind.RESAMPLE, fps=5000.0), "steps.0.fps"),
        (EditStep(EditKind.LOOP, min_seconds=2.0, max_seconds=1.0), "steps.0.max_seconds"),
    ],
)
def test_a_step_that_makes_no_sense_is_refused(
    ready_library: Library, ready_clips: list[ClipRecord], step: EditStep, place: str
) -> None:
    with pytest.raises(BadField) as refused:
        edit_clip(ready_library, ready_clips[0].id, [step])
    assert [one.location for one in refused.value.places] == [place]


def test_what_cannot_be_edited_is_refused(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    with pytest.raises(BadField):
        edit_clip(ready_library, ready_clips[0].id, [])
    with pytest.raises(ClipNotFound):
        edit_clip(ready_library, "clip_none", [MIRROR])
    with pytest.raises(TooShort):
        edit_clip(ready_library, ready_clips[0].id, [EditStep(EditKind.LOOP, min_seconds=500.0)])
