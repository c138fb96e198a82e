"""The training set has recordings of people and no synthesized clips."""

from __future__ import annotations

from app.demo import DemoClip
from app.services.library.library import Library
from app.services.library.synthesized import SYNTHESIZED
from app.services.training.training_set import read_training_set, ready_only
from app.store.clips.filter import ClipFilter
from app.store.clips.listing import list_ids
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
