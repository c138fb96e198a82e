"""Finds the keypoints of people in a value in JSON.

Programs nest them differently: a list of frames, of which each has `people`, `instances` or the
keypoints themselves. Keypoints are rows of numbers, one flat list, objects with x, y and z, or an
object by name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.formats.bvh.frames import MAX_FRAMES
from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.limits import MAX_JOINTS

FRAMES = (
    "instance_info", "frames", "predictions", "results", "annotations", "data", "sequence",
    "poses_3d", "keypoints_3d", "keypoints3d", "positions", "keypoints", "joints", "joints3d",
)  # fmt: skip
"""The names of the list of frames."""
PEOPLE = ("people", "instances", "persons", "annots", "bodies", "skeletons", "objects")
"""The names of the list of people in a frame."""
KEYPOINTS = (
    "pose_keypoints_3d", "keypoints_3d", "keypoints3d", "keypoints_3d_world", "pred_keypoints_3d",
    "world_landmarks", "pose_world_landmarks", "poseWorldLandmarks", "pose3d", "pose_3d",
    "joints3d", "joints_3d", "positions", "keypoints", "joints", "landmarks", "pose_keypoints_2d",
    "keypoints_2d",
)  # fmt: skip
"""The names of the keypoints of a person, 3-D before 2-D."""
IDS = ("track_id", "id", "person_id", "instance_id")
_TIMES = ("timestamp", "time", "t", "time_s")
MAX_DEPTH = 4
"""The most objects between the top level and the frames."""

Row = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Person:
    """A person in a frame. number: by which the person is known in other frames.

    rows: the numbers of each keypoint. names: of the keypoints, if each has one. key: the name of
    the list.
    """

    number: int
    rows: tuple[Row, ...]
    names: tuple[str, ...]
    key: str


@dataclass(frozen=True, slots=True)
class Frame:
    """The people of a frame, and its time in seconds if it has one."""

    people: tuple[Person, ...]
    time: float | None


def find_frames(document: Any) -> list[Frame]:
    """The frames of a document. Raises Unreadable, TooLarge."""
    entries = _entries(document, 0)
    if entries is None:
        keys = ", ".join(list(document)[:10]) if isinstance(document, dict) else "a list"
        raise unreadable_at("JSON", f"expected frames of 3-D keypoints, found {keys:.200}")
    if len(entries) > MAX_FRAMES:
        raise too_large("JSON", f"expected at most {MAX_FRAMES} frames")
    return [_frame(entry, index) for index, entry in enumerate(entries)]


def _entries(value: Any, depth: int) -> Sequence[Any] | None:
    """The list of frames; a single frame is a list of one."""
    if isinstance(value, list):
        return [value] if _is_rows(value) else value
    if not isinstance(value, dict) or depth > MAX_DEPTH:
        return None
    if any(name in value for name in PEOPLE):
        return [value]
    for name in FRAMES:
        found = value.get(name)
        if isinstance(found, dict) or (isinstance(found, list) and found):
            return [value] if _is_rows(found) else _entries(found, depth + 1)
    return [value] if any(name in value for name in KEYPOINTS) else _by_number(value)


def _by_number(value: Mapping[str, Any]) -> Sequence[Any] | None:
    """The frames of an object by their numbers."""
    if not value or not all(key.isdecimal() and len(key) < 10 for key in value):
        return None
    return [value[key] for key in sorted(value, key=int)]


def _is_rows(value: Any) -> bool:
    """Whether a list is the keypoints of one person."""
    if not isinstance(value, list) or not value:
        return False
    first = value[0]
    if isinstance(first, list):
        return bool(first) and _is_number(first[0])
    return _is_number(first) or (isinstance(first, dict) and "x" in first)


def _frame(entry: Any, index: int) -> Frame:
    people = tuple(_people(entry, f"frame {index}"))
    time = None
    if isinstance(entry, dict):
        time = next((float(entry[t]) for t in _TIMES if _is_small(entry.get(t))), None)
    return Frame(people, time)


def _people(entry: Any, location: str) -> Iterator[Person]:
    if isinstance(entry, dict):
        for name in PEOPLE:
            if isinstance(entry.get(name), list):
                for order, one in enumerate(entry[name]):
                    yield from _person(one, order, location)
                return
    # A list of people in which each has keypoints, as EasyMocap writes it.
    if isinstance(entry, list) and entry and not _is_rows(entry):
        for order, one in enumerate(entry):
            yield from _person(one, order, location)
        return
    yield from _person(entry, 0, location)


def _person(value: Any, order: int, location: str) -> Iterator[Person]:
    number = order
    key = ""
    if isinstance(value, dict):
        number = next((int(value[name]) for name in IDS if _is_whole(value.get(name))), order)
        key = next((name for name in KEYPOINTS if value.get(name)), "")
        value = value.get(key) if key else value
        # Some programs wrap the keypoints of the only person in one more list.
        if isinstance(value, list) and len(value) == 1 and _is_rows(value[0]) and key:
            value = value[0] if isinstance(value[0][0], list) else value
    rows = _rows(value, key, location)
    if rows is not None:
        yield Person(number, rows, _names(value), key)


def _rows(value: Any, key: str, location: str) -> tuple[Row, ...] | None:
    """The numbers of each keypoint; None if the value has no keypoints. Raises Unreadable."""
    if isinstance(value, dict):
        value = list(value.values())
    if not isinstance(value, list) or not value:
        return None
    if _is_number(value[0]):
        value = _folded(value, key, location)
    if len(value) > MAX_JOINTS:
        raise too_large(location, f"expected at most {MAX_JOINTS} keypoints")
    rows = tuple(_row(one, location) for one in value)
    if len({len(row) for row in rows}) > 1:
        raise unreadable_at(location, "expected the same count of numbers of each keypoint")
    return rows


def _row(value: Any, location: str) -> Row:
    if isinstance(value, dict):
        value = [value.get(axis) for axis in ("x", "y", "z") if axis in value]
    if value is None:
        return (float("nan"),) * 3
    if not isinstance(value, list) or len(value) > 4 or not all(map(_is_number_or_none, value)):
        raise unreadable_at(location, f"expected three numbers, found {str(value)[:40]!r}")
    return tuple(float("nan") if one is None else float(one) for one in value)


def _folded(flat: list[Any], key: str, location: str) -> list[Any]:
    """The rows of a flat list. OpenPose writes a confidence after each point."""
    is_2d = key.endswith("2d")
    width = 4 if key.endswith("_3d") and len(flat) % 4 == 0 else 3
    if len(flat) % width and len(flat) % 4 == 0:
        width = 4
    if len(flat) % width:
        raise unreadable_at(location, f"expected three numbers a keypoint, found {len(flat)}")
    rows = [flat[at : at + width] for at in range(0, len(flat), width)]
    return [row[:2] for row in rows] if is_2d else rows


def _names(value: Any) -> tuple[str, ...]:
    if isinstance(value, dict):
        return tuple(str(name)[:200] for name in value)
    if isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        found = [next((one[n] for n in ("name", "joint", "part") if n in one), "") for one in value]
        if all(isinstance(name, str) and name for name in found):
            return tuple(name[:200] for name in found)
    return ()


def _is_number(value: Any) -> bool:
    return type(value) in (int, float)


def _is_whole(value: Any) -> bool:
    return type(value) is int and abs(value) < 2**53


def _is_small(value: Any) -> bool:
    """Whether a value is a number that fits in a float."""
    return _is_number(value) and abs(value) < 1e300


def _is_number_or_none(value: Any) -> bool:
    # NaN is the only value that differs from itself.
    return value is None or _is_small(value) or (type(value) is float and value != value)
