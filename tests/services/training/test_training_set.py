"""The training set has recordings of people and no synthesized clips."""

from __future__ import annotations

import io

import numpy as np

from app.demo import DemoClip
from app.formats.bvh.reader import read_bvh
from app.formats.npz.writer import write_npz
from app.services.clips import catalogue
from app.services.library.library import Library
from app.services.library.synthesized import SYNTHESIZED
from app.services.training.training_set import read_training_set, ready_only
from app.store.clips.filter import ClipFilter
from app.store.clips.listing import list_ids
from app.store.clips.repository import get
from tests.libraries import upload, work


def test_synthesized_clips_are_in_no_training_set(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    sources = ("studio", SYNTHESIZED, "field", None)
    ids = [
        upload(lib, clip, source=source).clip.id
        for clip, source in zip(some_demo_clips, sources, strict=False)
    ]
    work(lib.settings)
    studio, made, field, unsaid = ids

    def judged(filter: ClipFilter | None) -> set[str]:
        with lib.store.read() as tx:
            return set(list_ids(tx, ready_only(filter)))

    assert judged(None) == {studio, field, unsaid}
    assert judged(ClipFilter(not_source=("field",))) == {studio, unsaid}
    assert judged(ClipFilter(source=(SYNTHESIZED,))) == set()
    assert made not in {clip.id for clip in read_training_set(lib.store).clips}


def test_models_do_not_learn_from_a_part_of_a_body(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    whole = upload(lib, some_demo_clips[0]).clip
    recording = read_bvh(some_demo_clips[0].content)
    legs = [
        joint
        for joint, name in enumerate(recording.skeleton.names)
        if any(part in name for part in ("Hips", "Leg", "Foot", "Toe"))
    ]
    content = write_npz(
        [recording.skeleton.names[joint] for joint in legs],
        np.full(len(legs), -1),
        recording.positions[:, legs] / 100,
        30.0,
    )
    part = catalogue.create_clip(lib, io.BytesIO(content), "legs.npz", {"task": "walk"}).clip
    work(lib.settings)
    with lib.store.read() as tx:
        found = get(tx, part.id)
    assert found.state == "ready"
    assert "neck" in found.missing_roles
    assert [clip.id for clip in read_training_set(lib.store).clips] == [whole.id]


def test_clips_have_disturbed_copies(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    for clip in some_demo_clips[:2]:
        upload(lib, clip)
    work(lib.settings)
    training = read_training_set(lib.store)
    copies = training.disturbed_copies()
    assert len(copies) == len(training) == 2
    for own, full in zip(copies, training.full_samples, strict=True):
        assert own is not None
        own = own[:-1]  # a mirrored kick is another kick
        apart = np.linalg.norm(own - full, axis=1)
        other = np.linalg.norm(own - training.full_samples.sum(axis=0) + full, axis=1)
        assert (apart < other).all()
