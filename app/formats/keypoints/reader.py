"""Reads JSON files of 3-D keypoints of one person: bytes in, Recording out.

OpenPose (`pose_keypoints_3d`), MMPose (`instance_info`), EasyMocap (`keypoints3d`), MediaPipe
(`world_landmarks`) and plain lists are read. The names of keypoints are in the file, or a known
order fits the body (`joint_layouts.py`). Unit and up axis are judged by the motion. Keypoints of a
picture (2-D) are refused, because no body can be found in them.

Sources: the documentation of OpenPose ("output"), MMPose ("inference"), EasyMocap and MediaPipe.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from app.errors import FormatNotSupported
from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.json_text import parse_json
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.common.world_positions import MAX_JOINT_FRAMES
from app.formats.keypoints.people import Frame, Person, find_frames
from app.formats.markers.recording import recording_of_markers
from app.formats.markers.tracks import Tracks
from app.formats.npz.joint_layouts import layout_of
from app.formats.tables.cells import rate_of_times
from app.kinedex_error import Place
from app.motion.skeleton.recording import FRAME_RATES, Caution, Recording
from app.numerics.arrays import FloatArray

_NAMES = (
    "keypoint_id2name", "joint_names", "keypoint_names", "keypoints_names", "names", "labels",
    "joints",
)  # fmt: skip
_RATES = ("fps", "frame_rate", "framerate", "frameRate", "FPS", "rate")
_META = ("meta_info", "meta", "metadata", "info", "header")
_OF_PICTURES = ("landmarks",)
"""The names of keypoints that MediaPipe gives as shares of the picture's width and height."""
MIN_PIXELS = 20.0
"""The smallest width or height of a body in pixels. In meters, no body moves so far."""
_VISIBILITIES = frozenset((0.0, 1.0, 2.0))
"""The third numbers of 2-D keypoints in the COCO format."""


def read_keypoints(content: bytes) -> Recording:
    """Read a JSON file of keypoints.

    Raises Unreadable with the frame, FormatNotSupported for 2-D keypoints, and TooLarge.
    """
    document = parse_json(content)
    frames = find_frames(document)
    number, cautions = _chosen(frames)
    people = [next((p for p in f.people if p.number == number), None) for f in frames]
    positions = _positions(people)
    names, more = _joint_names(document, people, positions)
    tracks = Tracks(
        labels=names,
        positions=positions,
        first_frame=0,
        frame_rate=_frame_rate(document, frames),
        up_axis="y",
        metres_per_unit=None,
        cautions=cautions + more,
    )
    return recording_of_markers(tracks, "json")


def _chosen(frames: Sequence[Frame]) -> tuple[int, tuple[Caution, ...]]:
    """The number of the person that is in the most frames."""
    counts = Counter(person.number for frame in frames for person in frame.people)
    if not counts:
        raise unreadable_at("JSON", "expected 3-D keypoints of a person, found none")
    number = counts.most_common(1)[0][0]
    if len(counts) == 1:
        return number, ()
    detail = f"the file has {len(counts)} people; number {number}, seen most often, is read"
    return number, (Caution("several_people", detail),)


def _positions(people: Sequence[Person | None]) -> FloatArray:
    """(frames, keypoints, 3) float32, NaN where the person or a keypoint was not seen."""
    first = next(person for person in people if person is not None)
    count, width = len(first.rows), len(first.rows[0])
    if width not in (3, 4):
        raise _flat(first, f"{width} numbers a keypoint")
    if len(people) * count > MAX_JOINT_FRAMES:
        raise too_large("JSON", f"expected at most {MAX_JOINT_FRAMES} keypoints times frames")
    numbers = np.full((len(people), count, width), np.nan)
    for index, person in enumerate(people):
        if person is None:
            continue
        if len(person.rows) != count or len(person.rows[0]) != width:
            found = f"{len(person.rows)} keypoints of {len(person.rows[0])} numbers"
            message = f"expected {count} keypoints of {width} numbers, found {found}"
            raise unreadable_at(f"frame {index}", message)
        numbers[index] = person.rows
    # A confidence of 0 and three zeros say that the keypoint was not seen.
    seen = (numbers[..., :3] != 0).any(axis=-1)
    if width == 4:
        seen &= numbers[..., 3] > 0
    positions = numbers[..., :3]
    if np.nanmax(np.abs(positions), initial=0.0) > MAX_MAGNITUDE:
        raise unreadable_at("JSON", f"expected numbers within ±{MAX_MAGNITUDE:g}")
    _refuse_pictures(positions[seen], first)
    positions[~seen | ~np.isfinite(positions).all(axis=-1)] = np.nan
    return positions.astype(np.float32)


def _refuse_pictures(points: FloatArray, person: Person) -> None:
    """Raise FormatNotSupported if points (n, 3) are places in a picture. person: for the error."""
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return
    low, high = points.min(axis=0), points.max(axis=0)
    # Confidences are within 0 and 1. A body in pixels is much larger than that.
    are_confidences = low[2] >= 0 and high[2] <= 1 and max((high - low)[:2]) > MIN_PIXELS
    if are_confidences or set(np.unique(points[:, 2])) <= _VISIBILITIES:
        raise _flat(person, "a visibility or a confidence in place of z")
    if person.key in _OF_PICTURES and min(low[:2]) >= 0 and max(high[:2]) <= 1:
        raise _flat(person, "places in a picture, as shares of its width and height")


def _flat(person: Person, found: str) -> FormatNotSupported:
    location = person.key or "JSON"
    return FormatNotSupported(
        "These keypoints are 2-D. Lift them to 3-D first, for example by Pose2Sim, MMPose's 3-D"
        " models or MediaPipe's world landmarks.",
        places=[Place(location, f"expected x, y and z of each keypoint, found {found}")],
    )


def _joint_names(
    document: Any, people: Sequence[Person | None], positions: FloatArray
) -> tuple[tuple[str, ...], tuple[Caution, ...]]:
    count = positions.shape[1]
    own = next((person.names for person in people if person is not None), ())
    for names in (own, *_declared_names(document)):
        if len(names) == count:
            return tuple(names), ()
    complete = positions[np.isfinite(positions).all(axis=(1, 2))]
    layout = layout_of(complete) if len(complete) else None
    if layout is None:
        detail = "the file has no joint names and no known joint order: send roles by joint_0, ..."
        labels = tuple(f"joint_{joint}" for joint in range(count))
        return labels, (Caution("joint_names_missing", detail),)
    detail = f"the file has no joint names; the body fits the joint order of {layout.title}"
    return layout.names, (Caution("joint_names_guessed", detail),)


def _places(document: Any) -> Iterator[dict[str, Any]]:
    """The objects that may describe the whole file."""
    if isinstance(document, dict):
        yield document
        yield from (document[name] for name in _META if isinstance(document.get(name), dict))


def _declared_names(document: Any) -> Iterator[tuple[str, ...]]:
    for place in _places(document):
        for key in _NAMES:
            found = place.get(key)
            if isinstance(found, dict):
                numbered = {k: v for k, v in found.items() if str(k).isdecimal() and len(k) < 10}
                found = [numbered[k] for k in sorted(numbered, key=int)]
            if isinstance(found, list) and all(isinstance(one, str) and one for one in found):
                yield tuple(one[:200] for one in found)


def _frame_rate(document: Any, frames: Sequence[Frame]) -> float | None:
    for place in _places(document):
        for key in _RATES:
            rate = place.get(key)
            if isinstance(rate, int | float) and FRAME_RATES[0] <= rate <= FRAME_RATES[1]:
                return float(rate)
    times = [frame.time for frame in frames]
    if any(time is None for time in times):
        return None
    measured = rate_of_times(np.array(times, dtype=np.float64))
    is_usable = measured is not None and FRAME_RATES[0] <= measured <= FRAME_RATES[1]
    return measured if is_usable else None
