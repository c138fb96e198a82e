"""Lists of clips: filters are compared with a plain loop, order and pages with `sorted`."""

from __future__ import annotations

import base64
import contextlib
import json
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import BadField, PageNotFound
from app.store.clips import listing as clip_listing
from app.store.clips import quality
from app.store.clips.filter import ClipFilter, MeasureBound
from app.store.clips.measures import MEASURES
from app.store.clips.record import ClipRecord, ClipState, ClipWarning
from app.store.store import Store
from tests.store.conftest import ON_ONE_STORE, AddClip

CLIPS: tuple[tuple[str, str | None, str | None, tuple[str, ...], float | None], ...] = (
    ("Walk 100%", "anna", "walk", ("walk", "slow"), 2.0),
    ("walk_2", "ben", "walk", ("walk",), 3.5),
    ("ÄRGER", "anna", "jump", ("jump", "slow"), 1.0),
    ("run", None, "run", (), 2.0),
    ("RUN", "ben", None, ("run",), None),
    ("back\\slash", None, None, (), None),
)
WARNINGS = (ClipWarning("frame_rate_suspect", "It looks too fast."),)


@pytest.fixture
def library_of_six(add_clip: AddClip) -> list[ClipRecord]:
    return [
        add_clip(
            name,
            ready=False
            if duration is None
            else {
                "duration": duration,
                "warnings": WARNINGS if name == "run" else (),
                "speed": 1.5 - 0.25 * duration,
                "travel": None if name == "run" else duration,
                "tempo": 120.0 if name == "run" else None,
            },
            person=person,
            task=task,
            words=words,
            license="CC0-1.0" if person == "anna" else None,
        )
        for name, person, task, words, duration in CLIPS
    ]


def names(store: Store, filter: ClipFilter) -> list[str]:
    with store.read() as tx:
        page = clip_listing.list_clips(tx, filter, sort="created_at")
        assert clip_listing.count_clips(tx, filter) == len(page.items)
        assert set(clip_listing.list_ids(tx, filter)) == {clip.id for clip in page.items}
    return [clip.name for clip in page.items]


@pytest.mark.parametrize(
    ("filter", "passes"),
    [
        (ClipFilter(), lambda c: True),
        (ClipFilter(person=("anna",)), lambda c: c.person == "anna"),
        (ClipFilter(person=("anna", "ben")), lambda c: c.person is not None),
        (ClipFilter(person=("nobody",)), lambda c: False),
        (ClipFilter(task=("walk",), person=("ben",)), lambda c: c.name == "walk_2"),
        (ClipFilter(word=("slow",)), lambda c: "slow" in c.words),
        (ClipFilter(word=("slow", "walk")), lambda c: {"slow", "walk"} & set(c.words)),
        (ClipFilter(license=("CC0-1.0",)), lambda c: c.license == "CC0-1.0"),
        (ClipFilter(source=("lab",)), lambda c: False),
        (ClipFilter(state=(ClipState.QUEUED,)), lambda c: c.duration is None),
        (ClipFilter(min_duration=2.0), lambda c: (c.duration or 0) >= 2),
        (ClipFilter(max_duration=2.0), lambda c: c.duration is not None and c.duration <= 2),
        (ClipFilter(min_speed=1.0), lambda c: c.speed is not None and c.speed >= 1),
        (ClipFilter(max_travel=2.0), lambda c: c.travel is not None and c.travel <= 2),
        (ClipFilter(min_tempo=100, max_tempo=140), lambda c: c.name == "run"),
        (ClipFilter(min_joints=22, max_joints=22), lambda c: c.joints == 22),
        (ClipFilter(max_frame_rate=1), lambda c: False),
        (ClipFilter(missing=("task",)), lambda c: c.task is None),
        (ClipFilter(missing=("person", "words")), lambda c: c.person is None or not c.words),
        (ClipFilter(has_warnings=True), lambda c: c.warnings),
        (ClipFilter(has_warnings=False), lambda c: not c.warnings),
        (ClipFilter(q="WALK"), lambda c: "walk" in c.name.lower()),
        (ClipFilter(q="ärger"), lambda c: c.name == "ÄRGER"),
        (ClipFilter(q="%"), lambda c: "%" in c.name),
        (ClipFilter(q="_"), lambda c: "_" in c.name),
        (ClipFilter(q="\\"), lambda c: "\\" in c.name),
        (ClipFilter(q="'; DROP TABLE clips; --"), lambda c: False),
        (ClipFilter(q=""), lambda c: True),
    ],
)
@pytest.mark.usefixtures("library_of_six")
def test_filters(
    store: Store,
    library_of_six: list[ClipRecord],
    filter: ClipFilter,
    passes: Callable[[ClipRecord], object],
) -> None:
    assert names(store, filter) == [clip.name for clip in library_of_six if passes(clip)]


def measured(name: str) -> Callable[[ClipRecord], object]:
    """The key by which a list is sorted by a measure: clips without it come first."""
    return lambda clip: (-1.0 if (value := getattr(clip, name)) is None else value, clip.id)


KEYS: dict[str, Callable[[ClipRecord], object]] = {
    "created_at": lambda c: (c.created_at, c.id),
    "name": lambda c: (c.name.casefold(), c.id),
    **{name: measured(name) for name in MEASURES},
    "person": lambda c: (c.person or "", c.id),
    "task": lambda c: (c.task or "", c.id),
}


@pytest.mark.parametrize("limit", [1, 2, 6, 50])
@pytest.mark.parametrize("descending", [False, True])
@pytest.mark.parametrize("name", KEYS)
def test_pages_put_together_are_the_sorted_list(
    store: Store, library_of_six: list[ClipRecord], name: str, descending: bool, limit: int
) -> None:
    sort = "-" + name if descending else name
    seen: list[ClipRecord] = []
    cursor: str | None = None
    with store.read() as tx:
        while True:
            page = clip_listing.list_clips(tx, ClipFilter(), sort=sort, limit=limit, cursor=cursor)
            assert len(page.items) <= limit
            seen += page.items
            if (cursor := page.next) is None:
                break
    assert seen == sorted(library_of_six, key=KEYS[name], reverse=descending)


@pytest.mark.parametrize("descending", [False, True])
def test_lists_are_sorted_and_filtered_by_measures_of_quality(
    store: Store, library_of_six: list[ClipRecord], descending: bool
) -> None:
    """Some values are negative, and a clip without the measure comes before all of them."""
    known = {clip.id: value for clip, value in zip(library_of_six, (-3.0, 2.5, 0.0), strict=False)}
    with store.write() as tx:
        for clip_id, value in known.items():
            quality.put(tx, clip_id, {"dominance": value})
    sort = "-dominance" if descending else "dominance"
    with store.read() as tx:
        page = clip_listing.list_clips(tx, ClipFilter(), sort=sort, limit=50)
        found = [known.get(clip.id) for clip in page.items]
        low = clip_listing.list_ids(
            tx, ClipFilter(measured=(MeasureBound("dominance", None, 0.0),))
        )
        some = clip_listing.list_ids(tx, ClipFilter(measured=(MeasureBound("dominance", -1, 3),)))
        assert quality.get(tx, page.items[0].id)["turn"] is None
    expected = [None, None, None, -3.0, 0.0, 2.5]
    assert found == (expected[::-1] if descending else expected)
    assert set(low) == {clip_id for clip_id, value in known.items() if value <= 0}
    assert set(some) == {clip_id for clip_id, value in known.items() if value >= -1}


def test_a_page_is_stable_while_clips_come_and_go(
    store: Store, library_of_six: list[ClipRecord], add_clip: AddClip
) -> None:
    with store.read() as tx:
        first = clip_listing.list_clips(tx, ClipFilter(), sort="name", limit=3)
    add_clip("aaa")
    add_clip("zzz")
    with store.read() as tx:
        rest = clip_listing.list_clips(tx, ClipFilter(), sort="name", cursor=first.next)
    shown = [clip.name for clip in (*first.items, *rest.items)]
    assert sorted(shown) == sorted([*(clip.name for clip in library_of_six), "zzz"])


def packed(content: object) -> str:
    return base64.urlsafe_b64encode(json.dumps(content).encode()).decode()


@pytest.mark.parametrize(
    "cursor",
    [
        "",
        "?",
        "äöü",
        "bm90IGpzb24",
        packed(None),
        packed(["name"]),
        packed(["-name", "x", "clip"]),
        packed(["name", 3, "clip"]),
        packed(["name", "x", None]),
        "A" * 100_000,
        packed([[]] * 500),
    ],
)
def test_bad_cursors_name_the_field(store: Store, cursor: str) -> None:
    with pytest.raises(PageNotFound) as failure, store.read() as tx:
        clip_listing.list_clips(tx, ClipFilter(), sort="name", cursor=cursor)
    assert [place.location for place in failure.value.places] == ["cursor"]


@ON_ONE_STORE
@given(
    cursor=st.one_of(st.text(), st.binary().map(lambda b: base64.urlsafe_b64encode(b).decode())),
    sort=st.sampled_from(["name", "-duration", "created_at"]),
)
def test_any_cursor_is_read_or_refused(store: Store, cursor: str, sort: str) -> None:
    with store.read() as tx, contextlib.suppress(PageNotFound):
        clip_listing.list_clips(tx, ClipFilter(), sort=sort, cursor=cursor)


@pytest.mark.parametrize(
    ("sort", "value"),
    [
        *(("duration", value) for value in ("1e400", "NaN", "-Infinity", "1" + "0" * 400, "true")),
        ("created_at", '"0001-01-01T00:00:00+14:00"'),
        ("created_at", '"2026-01-01T00:00:00"'),
        ("created_at", '"yesterday"'),
        ("name", '"\\ud800"'),
    ],
)
def test_values_that_no_row_can_have_are_refused(store: Store, sort: str, value: str) -> None:
    cursor = base64.urlsafe_b64encode(f'["{sort}",{value},"clip"]'.encode()).decode()
    with pytest.raises(PageNotFound), store.read() as tx:
        clip_listing.list_clips(tx, ClipFilter(), sort=sort, cursor=cursor)


@pytest.mark.parametrize("sort", ["", "-", "sha256", "--name", "name "])
def test_bad_sorts_name_the_field(store: Store, sort: str) -> None:
    with pytest.raises(BadField) as failure, store.read() as tx:
        clip_listing.list_clips(tx, ClipFilter(), sort=sort)
    assert failure.value.places[0].location == "sort"
