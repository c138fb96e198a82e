"""The map of all motions: a point for each clip, similar clips near, new clips at once."""

from __future__ import annotations

import numpy as np
import pytest

from app.demo import DemoClip
from app.errors import BadField, ModelNotFitted
from app.services.find import map as space
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter
from tests.libraries import upload, work


@pytest.mark.parametrize("name", space.SPACES)
@pytest.mark.parametrize("dimensions", space.DIMENSIONS)
def test_every_clip_is_on_the_map_near_similar_clips(
    ready_library: Library, name: str, dimensions: int
) -> None:
    found = space.draw_map(ready_library, name, dimensions)
    assert found.points.shape == (12, dimensions) == (found.total, dimensions)
    assert len({clip.id for clip in found.clips}) == 12
    assert 0.3 < found.kept <= 1.0 + 1e-9
    gaps = np.linalg.norm(found.points[:, None] - found.points, axis=2)
    same = np.array([[a.task == b.task for a in found.clips] for b in found.clips])
    assert gaps[same & (gaps > 0)].mean() < 0.7 * gaps[~same].mean()


def test_a_filter_and_a_limit_leave_points_where_they_are(ready_library: Library) -> None:
    whole = space.draw_map(ready_library)
    walks = space.draw_map(ready_library, clip_filter=ClipFilter(task=("walk",)))
    place = {clip.id: point for clip, point in zip(whole.clips, whole.points, strict=True)}
    assert {clip.task for clip in walks.clips} == {"walk"}
    for clip, point in zip(walks.clips, walks.points, strict=True):
        assert np.allclose(point, place[clip.id])
    few = space.draw_map(ready_library, limit=5)
    assert (len(few.clips), few.total) == (5, 12)


def test_a_new_clip_is_placed_without_a_fit(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    for clip in some_demo_clips[:3]:
        upload(lib, clip)
    work(lib.settings)
    with pytest.raises(ModelNotFitted):
        space.draw_map(lib)
    assert len(space.draw_map(lib, "vectors").clips) == 3


@pytest.mark.parametrize("name", space.SPACES)
def test_points_need_no_records(ready_library: Library, name: str) -> None:
    """The clips placed from the index alone are those of the map, in the same places."""
    whole, placed = space.draw_map(ready_library, name), space.place_clips(ready_library, name)
    assert placed.ids == [clip.id for clip in whole.clips]
    assert np.array_equal(placed.points, whole.points)
    assert (placed.total, placed.model) == (whole.total, whole.model)


def test_an_empty_library_has_an_empty_map(lib: Library) -> None:
    assert space.draw_map(lib, "vectors").points.shape == (0, 2)


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({"space": "words"}, "space"),
        ({"dimensions": 4}, "dimensions"),
        ({"limit": 0}, "limit"),
    ],
)
def test_impossible_maps_are_refused(
    ready_library: Library, asked: dict[str, object], field: str
) -> None:
    with pytest.raises(BadField) as refused:
        space.draw_map(ready_library, **asked)  # type: ignore[arg-type]
    assert refused.value.places[0].location == field
