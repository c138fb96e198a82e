"""Near-duplicates in a library: groups, keepers, new clips, dismissed and deleted ones."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest

from app.demo import DemoClip
from app.errors import NotFound
from app.formats.npz.writer import write_npz
from app.motion.motion import Motion
from app.services.clips import catalogue as clips
from app.services.curation import comparison, duplicates
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from tests.libraries import upload, work


def compare(lib: Library) -> int:
    return max(comparison.compare_pending(lib), default=0)


def add(lib: Library, motion: Motion, name: str) -> str:
    names = [next((r.value for r, j in motion.roles.items() if j == place), name)
             for place, name in enumerate(motion.names)]  # fmt: skip
    content = write_npz(names, motion.parents, motion.positions, motion.frame_rate)
    return clips.create_clip(lib, io.BytesIO(content), f"{name}.npz").clip.id


def kinds(lib: Library, **options: float) -> dict[frozenset[str], str]:
    groups = duplicates.list_groups(lib, limit=100, **options).page.items  # type: ignore[arg-type]
    return {frozenset(pair.ids): pair.kind for group in groups for pair in group.pairs}


@pytest.fixture
def copied(lib: Library, some_demo_clips: list[DemoClip]) -> dict[str, str]:
    """A library of six clips, and three copies of the first one: ids by name."""
    ids = [upload(lib, clip).clip.id for clip in some_demo_clips[:6]]
    work(lib.settings)
    motion = load_motion(lib, clips.get_clip(lib, ids[0]))
    some = motion.positions
    mirrored = replace(
        motion,
        positions=some * np.array([-1, 1, 1], dtype=np.float32),
        roles={role.mirrored(): joint for role, joint in motion.roles.items()},
    )
    found = {
        "original": ids[0],
        "cut": add(lib, replace(motion, positions=some[len(some) // 4 :]), "cut"),
        "mirror": add(lib, mirrored, "mirror"),
    }
    work(lib.settings)
    return found


def test_copies_are_one_group_and_the_longest_is_kept(lib: Library, copied: dict[str, str]) -> None:
    assert compare(lib) <= 8  # the worker may have compared some, or all
    while compare(lib):
        pass
    found = duplicates.list_groups(lib)
    (group,) = found.page.items
    assert (found.pending, found.page.total) == (0, 1)
    assert {clip.id for clip in group.clips} == set(copied.values())
    assert group.keeper == group.clips[0].id == copied["original"]
    own = kinds(lib)
    assert own[frozenset((copied["original"], copied["cut"]))] == "cut"
    assert own[frozenset((copied["original"], copied["mirror"]))] == "mirror"


def test_new_clips_are_compared_and_deleted_ones_leave(
    lib: Library, copied: dict[str, str]
) -> None:
    compare(lib)
    motion = load_motion(lib, clips.get_clip(lib, copied["original"]))
    again = add(lib, motion, "again")
    work(lib.settings)
    compare(lib)
    assert kinds(lib)[frozenset((copied["original"], again))] == "format"
    for name in ("cut", "mirror"):
        clips.delete_clip(lib, copied[name])
    assert set(kinds(lib)) == {frozenset((copied["original"], again))}


def test_a_dismissed_group_does_not_come_back(lib: Library, copied: dict[str, str]) -> None:
    compare(lib)
    (group,) = duplicates.list_groups(lib).page.items
    duplicates.dismiss(lib, group.id)
    clips.update_clip(lib, copied["original"], {"task": "strut"})
    assert duplicates.list_groups(lib).pending == 1
    assert compare(lib) == 1
    assert kinds(lib) == {}
    with pytest.raises(NotFound):
        duplicates.dismiss(lib, group.id)


def test_the_threshold_adds_other_takes(lib: Library, copied: dict[str, str]) -> None:
    compare(lib)
    assert "similar" not in kinds(lib).values()
    wide = kinds(lib, threshold=0.5)
    assert kinds(lib).items() <= wide.items()


def test_pages_put_together_are_the_whole_list(lib: Library, copied: dict[str, str]) -> None:
    motion = load_motion(lib, clips.list_clips(lib, sort="name", limit=1).items[0])
    add(lib, motion, "another")
    work(lib.settings)
    compare(lib)
    whole = duplicates.list_groups(lib, limit=100, threshold=0.5).page.items
    seen, cursor = [], None
    while True:
        page = duplicates.list_groups(lib, limit=1, threshold=0.5, cursor=cursor).page
        seen += page.items
        if (cursor := page.next) is None:
            break
    assert [group.id for group in seen] == [group.id for group in whole]
