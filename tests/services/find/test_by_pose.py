"""Searches by pose over a library that a worker has analyzed."""

from __future__ import annotations

import io
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from app.analysis.descriptors.pose_cover import pose_vectors
from app.demo import DemoClip
from app.errors import BadField, ClipNotFound, ClipNotReady, PageNotFound
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.search.pose.by_pose import pose_distances
from app.services.clips import catalogue as clips
from app.services.find.by_pose import find_pose
from app.services.find.hits import Hits
from app.services.find.queries import PoseQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.store.clips import arrays
from app.store.clips.record import ClipRecord
from tests.bodies import turned_about_y
from tests.libraries import FindClip
from tests.queries import pose_query

TIME = 0.7


def _positions(lib: Library, clip: ClipRecord) -> np.ndarray:
    with lib.store.read() as tx:
        return arrays.get_one(tx, clip.id, "role_positions")


def _pages(lib: Library, size: int, **query: Any) -> list[Hits]:
    pages = [find_pose(lib, pose_query(limit=size, **query))]
    while pages[-1].next is not None:
        pages.append(find_pose(lib, pose_query(limit=size, cursor=pages[-1].next, **query)))
    return pages


def test_each_hit_has_the_time_of_its_nearest_frame(
    ready_library: Library, ready_clips: list[ClipRecord], clip_of: FindClip
) -> None:
    query = clip_of("ada", "kick")
    foot = _positions(ready_library, query)[:, SUN_ROLES.index(JointRole.RIGHT_FOOT), 1]
    frame = int(np.argmax(foot))
    hits = find_pose(ready_library, PoseQuery(QuerySource(query.id), time=frame / 30, limit=100))
    assert (hits.method, hits.next) == ("pose", None)
    assert {hit.clip.id for hit in hits.items} == {c.id for c in ready_clips} - {query.id}
    assert hits.items[0].clip.task == "kick"
    pose = pose_vectors(_positions(ready_library, query)[[frame]])[0]
    for hit in hits.items:
        distances = pose_distances(_positions(ready_library, hit.clip), pose)
        assert hit.distance == pytest.approx(distances.min(), abs=1e-8)
        assert distances[round((hit.time or 0.0) * 30)] == pytest.approx(hit.distance, abs=1e-8)
        assert 0 <= hit.start <= (hit.time or 0.0) < hit.end <= (hit.clip.duration or 0.0)
        assert hit.score == pytest.approx(0.25 / (0.25 + hit.distance))
    assert [hit.rank for hit in hits.items] == list(range(1, len(ready_clips)))


def test_the_pose_of_a_hit_is_found_at_distance_zero(
    ready_library: Library, clip_of: FindClip
) -> None:
    first = find_pose(
        ready_library, PoseQuery(QuerySource(clip_of("ada", "wave").id), time=TIME)
    ).items[0]
    again = PoseQuery(QuerySource(first.clip.id), time=first.time, include_self=True)
    (found, *_) = find_pose(ready_library, again).items
    assert (found.clip.id, found.time, found.distance) == (first.clip.id, first.time, 0.0)
    assert found.score == 1.0


def test_positions_give_the_same_hits_for_any_position_of_the_body(
    ready_library: Library, clip_of: FindClip
) -> None:
    query = clip_of("bruno", "bow")
    pose = _positions(ready_library, query)[[round(TIME * 30)]]
    by_time = find_pose(
        ready_library, PoseQuery(QuerySource(query.id), time=TIME, include_self=True)
    )
    moved = 100 * turned_about_y(pose, 2.5)[0] + np.array([70.0, 5.0, -3.0])
    for positions in (pose[0], moved):
        hits = find_pose(ready_library, PoseQuery(positions=positions.tolist()))
        assert [h.clip.id for h in hits.items] == [h.clip.id for h in by_time.items]
        assert [h.distance for h in hits.items] == pytest.approx(
            [h.distance for h in by_time.items], abs=1e-5
        )


@pytest.mark.parametrize("places", ["best", "all"])
def test_all_pages_together_are_the_whole_ranking(
    ready_library: Library, clip_of: FindClip, places: str
) -> None:
    query = {"clip_id": clip_of("ada", "walk").id, "time": TIME, "places": places}
    (whole,) = _pages(ready_library, 1000, **query)
    hits = [hit for page in _pages(ready_library, 4, **query) for hit in page.items]
    assert [(h.rank, h.clip.id, h.time, h.distance) for h in hits] == [
        (h.rank, h.clip.id, h.time, h.distance) for h in whole.items
    ]


def test_the_pose_of_a_walk_is_found_in_every_cycle(
    ready_library: Library, clip_of: FindClip
) -> None:
    walk = clip_of("ada", "walk")
    query = PoseQuery(QuerySource(walk.id), time=TIME, places="all", include_self=True, limit=1000)
    hits = [h for h in find_pose(ready_library, query).items if h.clip.id == walk.id]
    near = sorted(h.time or 0.0 for h in hits if h.distance < 0.05)
    assert len(near) > 1
    assert np.diff(near).min() > 0.5
    spans = sorted((h.start, h.end) for h in hits)
    assert all(one[1] <= other[0] for one, other in pairwise(spans))


def test_a_filter_is_applied_before_the_ranking(ready_library: Library, clip_of: FindClip) -> None:
    query = PoseQuery(
        QuerySource(clip_of("ada", "kick").id), time=TIME, limit=1, filter={"task": "bow"}
    )
    (hit,) = find_pose(ready_library, query).items
    assert hit.clip.task == "bow"
    nothing = find_pose(ready_library, PoseQuery(query.source, time=TIME, filter={"task": "x"}))
    assert (nothing.items, nothing.next) == ((), None)


def test_a_query_by_a_file_does_not_store_it(
    ready_library: Library, some_demo_clips: list[DemoClip], clip_of: FindClip
) -> None:
    kick = next(c for c in some_demo_clips if (c.person, c.task) == ("ada", "kick"))
    source = QuerySource(content=io.BytesIO(kick.content))
    query = PoseQuery(source, time=TIME, include_self=True)
    (first, *_) = find_pose(ready_library, query).items
    assert first.clip.id == clip_of("ada", "kick").id
    assert (first.distance, first.time) == (pytest.approx(0.0, abs=1e-6), pytest.approx(TIME))


GOOD = np.random.default_rng(0).normal(size=(13, 3)).tolist()


def _with(index: int, point: Any) -> list[Any]:
    return [point if i == index else p for i, p in enumerate(GOOD)]


@pytest.mark.parametrize(
    ("positions", "location", "message"),
    [
        (GOOD[:12], "positions", "expected 13 points"),
        (_with(3, [float("nan"), 0, 0]), "positions.3", "right_foot"),
        (_with(0, [float("inf"), 0, 0]), "positions.0", "left_knee"),
        (_with(12, [0, 0]), "positions.12", "right_hand"),
        (_with(9, [0, True, 0]), "positions.9", "neck"),
        (_with(9, "here"), "positions.9", "neck"),
        (_with(4, [1e9, 0, 0]), "positions.4", "hips: farther than"),
        ([[1.0, 1.0, 1.0]] * 13, "positions", "all joints have the same position"),
        ([[0.0, 0.1 * i, 0.0] for i in range(13)], "positions.7", "no left and right"),
    ],
)
def test_a_bad_pose_is_refused_by_its_joint(
    ready_library: Library, positions: list[Any], location: str, message: str
) -> None:
    with pytest.raises(BadField) as refused:
        find_pose(ready_library, PoseQuery(positions=positions))
    place = next(p for p in refused.value.places if p.location == location)
    assert message in place.message


def test_every_bad_joint_is_named(ready_library: Library) -> None:
    with pytest.raises(BadField) as refused:
        find_pose(ready_library, PoseQuery(positions=[["x"]] * 13))
    assert [p.message.split(":")[0] for p in refused.value.places] == list(SUN_ROLES)


@pytest.mark.parametrize(
    ("wrong", "location"),
    [
        ({"time": None}, "time"),
        ({"time": -0.1}, "time"),
        ({"time": 1e6}, "time"),
        ({"time": float("nan")}, "time"),
        ({"clip_id": None, "time": None}, "positions"),
        ({"positions": GOOD}, "clip_id"),
        ({"places": "some"}, "places"),
        ({"limit": 0}, "limit"),
        ({"limit": 1001}, "limit"),
        ({"filter": {"tusk": "walk"}}, "filter.tusk"),
        ({"unit": "m"}, "unit"),
    ],
)
def test_a_bad_query_is_refused_by_its_field(
    ready_library: Library, clip_of: FindClip, wrong: dict[str, Any], location: str
) -> None:
    query = {"clip_id": clip_of("ada", "walk").id, "time": TIME} | wrong
    with pytest.raises(BadField) as refused:
        find_pose(ready_library, pose_query(**query))
    assert refused.value.places[0].location == location


def test_a_cursor_of_another_pose_is_refused(ready_library: Library, clip_of: FindClip) -> None:
    walk = clip_of("ada", "walk").id
    page = find_pose(ready_library, PoseQuery(QuerySource(walk), time=TIME, limit=1))
    with pytest.raises(PageNotFound):
        find_pose(
            ready_library, PoseQuery(QuerySource(walk), time=TIME + 0.5, limit=1, cursor=page.next)
        )


def test_a_missing_clip_and_a_clip_that_is_not_ready_are_refused(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    with pytest.raises(ClipNotFound):
        find_pose(lib, PoseQuery(QuerySource("clip_of_nobody"), time=0.0))
    made = clips.create_clip(lib, io.BytesIO(some_demo_clips[0].content), "a.bvh")
    with pytest.raises(ClipNotReady):
        find_pose(lib, PoseQuery(QuerySource(made.clip.id), time=0.0))
    assert find_pose(lib, PoseQuery(positions=GOOD)).items == ()


def test_a_stored_file_does_not_find_itself_unless_it_may(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("ada", "kick")
    content = ready_library.store.files.path(clip.sha256).read_bytes()

    def found(**more: Any) -> list[str]:
        source = QuerySource(content=io.BytesIO(content))
        query = PoseQuery(source, time=TIME, limit=1000, **more)
        return [hit.clip.id for hit in find_pose(ready_library, query).items]

    assert clip.id not in found()
    assert found(include_self=True)[0] == clip.id
