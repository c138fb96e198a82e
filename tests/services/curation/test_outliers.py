"""Outliers in a library: accepted ones get another label, dismissed ones leave the list."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from app.demo import demo_clips
from app.errors import Conflict, LicenseNotAllowed, NotFound
from app.search.outliers.outliers import OutlierReason
from app.services.clips import catalogue as clips
from app.services.curation import outliers
from app.services.curation.outliers import LabelOutlier, other_side
from app.services.find.find import find_motion
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.views.export import export
from app.store.clips.filter import ClipFilter
from app.store.clips.license_policy import only_licenses
from tests.libraries import settings_for, upload, work

FAR = OutlierReason.FAR


@pytest.fixture(scope="module")
def lib(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path_factory.mktemp("outliers"), refit_growth=1e9))
    for clip in demo_clips(["ada", "bruno", "chika"], ["walk", "wave"], takes=3):
        upload(opened, clip, license="CC0-1.0" if clip.task == "walk" else None)
    work(opened.settings)
    yield opened
    opened.close()


def far(lib: Library, clip_id: str) -> LabelOutlier | None:
    found = outliers.list_outliers(lib, ClipFilter(), limit=100)
    return next((o for o in found if (o.clip.id, o.reason) == (clip_id, FAR)), None)


def test_a_wrong_label_is_listed_and_accepted(lib: Library) -> None:
    walk = clips.list_clips(lib, ClipFilter(task=("walk",)), limit=1).items[0]
    assert far(lib, walk.id) is None
    clips.update_clip(lib, walk.id, {"task": "wave"})
    found = far(lib, walk.id)
    assert found is not None
    assert (found.task, found.suggested) == ("wave", "walk")
    assert outliers.accept(lib, walk.id, FAR, None).task == "walk"
    with pytest.raises(NotFound):
        outliers.accept(lib, walk.id, FAR, None)


def test_a_dismissed_outlier_returns_only_with_another_label(lib: Library) -> None:
    walk = clips.list_clips(lib, ClipFilter(task=("walk",)), limit=1).items[0]
    clips.update_clip(lib, walk.id, {"task": "wave"})
    outliers.dismiss(lib, walk.id, FAR)
    assert far(lib, walk.id) is None
    clips.update_clip(lib, walk.id, {"task": "walk"})
    clips.update_clip(lib, walk.id, {"task": None})
    with pytest.raises(NotFound):
        outliers.dismiss(lib, walk.id, FAR)
    clips.update_clip(lib, walk.id, {"task": "walk"})


def test_sides_are_exchanged() -> None:
    assert other_side("raise-left-hand") == "raise-right-hand"
    assert other_side("left_leg right_arm") == "right_leg left_arm"
    assert other_side("walk") == "walk"


def test_nothing_is_changed_without_a_suggestion(lib: Library) -> None:
    walk = clips.list_clips(lib, ClipFilter(task=("walk",)), limit=1).items[0]
    with pytest.raises((Conflict, NotFound)):
        outliers.accept(lib, walk.id, OutlierReason.SWAPPED, None)


def test_the_license_policy_holds_for_searches_and_exports(lib: Library) -> None:
    wave = clips.list_clips(lib, ClipFilter(task=("wave",)), limit=1).items[0]
    walk = clips.list_clips(lib, ClipFilter(task=("walk",)), limit=1).items[0]
    assert any(
        hit.clip.license is None
        for hit in find_motion(lib, MotionQuery(QuerySource(wave.id))).items
    )
    with only_licenses(("CC0-1.0",)):
        hits = find_motion(lib, MotionQuery(QuerySource(wave.id))).items
        assert hits
        assert {hit.clip.license for hit in hits} == {"CC0-1.0"}
        assert export(lib, walk.id, "npz").file_name
        with pytest.raises(LicenseNotAllowed):
            export(lib, wave.id, "npz")
        with pytest.raises(LicenseNotAllowed):
            clips.open_file(lib, wave.id)
    assert export(lib, wave.id, "npz").file_name
