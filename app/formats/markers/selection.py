"""Selects the markers of a file that are used.

These are the labeled markers of one subject, each label once, in the frames in which they are seen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.errors import Unreadable
from app.formats.common.names import without_common_prefix
from app.formats.markers.tracks import Tracks
from app.kinedex_error import Place
from app.motion.roles.marker_names import is_marker, markers_by_place, subject_and_label
from app.motion.skeleton.occlusion import Gap, hidden, longest_gap, without_sentinels
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import BoolArray, FloatArray

MIN_PREFIXED = 8
"""The fewest labels whose common beginning counts as the name of a subject."""
MAX_MARKERS_SHOWN = 8
"""The most markers that a caution or an error names."""


@dataclass(frozen=True, slots=True)
class Markers:
    """The markers of one person.

    labels: (markers,) without the name of the subject. positions: (frames, markers, 3) in the unit
    and axes of the file, NaN where a marker is not seen. first_frame: the number that the file
    gives to the first of these frames. skipped: the frames of the file before it.
    """

    labels: tuple[str, ...]
    positions: FloatArray
    first_frame: int
    skipped: int = 0
    cautions: tuple[Caution, ...] = ()


def labeled_markers(points: Tracks) -> Markers:
    """The markers of one subject that are seen, each label once.

    Frames at the start and at the end in which no marker is seen are left out. Raises Unreadable if
    no labeled marker is ever seen.
    """
    split = _split(points.labels)
    points = replace(points, positions=without_sentinels(points.positions))
    named = [
        index
        for index, (_, label) in enumerate(split)
        if is_marker(label) and points.labels[index] not in points.outputs
    ]
    seen = np.isfinite(points.positions[..., 0])
    named = [index for index in named if seen[:, index].any()]
    if not named:
        found = _listed([label[:40] for label in points.labels if label]) or "no labels"
        message = f"expected labeled markers that are seen, found: {found}"
        raise Unreadable(message, places=[Place("labels", message)])
    subject, cautions = _main_subject([split[index] for index in named])
    mine = [index for index in named if split[index][0] == subject]
    points_read, more_cautions = _each_once([(split[index][1], index) for index in mine], seen)
    seen_frames = np.flatnonzero(seen[:, points_read].any(axis=1))
    first, last = int(seen_frames[0]), int(seen_frames[-1]) + 1
    if last - first < len(seen):
        start, end = points.first_frame + first, points.first_frame + last - 1
        detail = f"no marker is seen before frame {start} or after frame {end}"
        more_cautions += (Caution("frames_trimmed", detail),)
    return Markers(
        tuple(split[index][1] for index in points_read),
        points.positions[first:last, points_read],
        points.first_frame + first,
        first,
        cautions + more_cautions,
    )


def _split(labels: Sequence[str]) -> list[tuple[str, str]]:
    """The subject and the rest of each label. Qualisys separates them by `_`, others by `:`."""
    split = [subject_and_label(label) for label in labels]
    named = [label for subject, label in split if is_marker(label) and not subject]
    plain = without_common_prefix(named)
    if len(named) < MIN_PREFIXED or plain == named:
        return split
    if len(markers_by_place(named)) >= len(markers_by_place(plain)):
        return split
    short = dict(zip(named, plain, strict=True))
    return [(subject, short.get(label, label)) for subject, label in split]


def _main_subject(names: Sequence[tuple[str, str]]) -> tuple[str, tuple[Caution, ...]]:
    """The subject with the most markers of known marker sets, or else with the most markers.

    names: the subject and the label of each marker. A caution names the other subjects.
    """
    by_subject: dict[str, list[str]] = {}
    for subject, label in names:
        by_subject.setdefault(subject, []).append(label)
    ranked = sorted(
        by_subject, key=lambda s: (-len(markers_by_place(by_subject[s])), -len(by_subject[s]))
    )
    others = [subject or "without a name" for subject in ranked[1:]]
    if not others:
        return ranked[0], ()
    detail = f"only subject {ranked[0] or 'without a name'} is read, not: {_listed(others)}"
    return ranked[0], (Caution("several_subjects", detail),)


def _each_once(
    named: Sequence[tuple[str, int]], seen: BoolArray
) -> tuple[list[int], tuple[Caution, ...]]:
    """The point of each label. If several have it, this is the one seen in the most frames.

    named: label and point. seen: (frames, points). A caution names the labels that occur twice.
    """
    best: dict[str, int] = {}
    for label, index in named:
        other = best.setdefault(label, index)
        if seen[:, index].sum() > seen[:, other].sum():
            best[label] = index
    counts = Counter(label for label, _ in named)
    twice = [label for label, count in counts.items() if count > 1]
    if not twice:
        return list(best.values()), ()
    detail = "several points have the same label; the one seen most often is read: "
    caution = Caution("duplicate_names", detail + _listed(twice), joint=twice[0])
    return list(best.values()), (caution,)


def hidden_too_long(markers: Markers, gaps: Sequence[Gap]) -> Unreadable:
    """The error for gaps that are too long, with their markers and frames."""
    places = []
    for gap in gaps[:MAX_MARKERS_SHOWN]:
        first, last = markers.first_frame + gap.start, markers.first_frame + gap.end - 1
        where = f"marker {markers.labels[gap.marker]}, frames {first} to {last}"
        places.append(Place(where, f"expected the marker, found it hidden for {last - first + 1}"))
    detail = "; ".join(place.location for place in places)
    return Unreadable(f"Markers are hidden for too long to be filled in: {detail}", places=places)


def gap_cautions(markers: Markers, stretch: slice, positions: FloatArray) -> tuple[Caution, ...]:
    """Cautions about gaps that were filled, and about markers that are left out for long gaps.

    stretch: the frames that are read. positions: (frames of the stretch, markers, 3), NaN in gaps
    that were not filled.
    """
    is_hidden = hidden(positions)
    filled: BoolArray = hidden(markers.positions[stretch]) & ~is_hidden
    cautions: tuple[Caution, ...] = ()
    if gap := longest_gap(filled):
        label, first = markers.labels[gap.marker], markers.first_frame + stretch.start
        detail = f"markers hidden for short times were filled in: {100 * filled.mean():.1f} % of"
        detail += f" their frames; longest {label}, frames {first + gap.start} to"
        detail += f" {first + gap.end - 1}"
        cautions += (Caution("gaps_filled", detail, frames=gap.frames, joint=label),)
    if gap := longest_gap(is_hidden):
        names = [markers.labels[marker] for marker in np.flatnonzero(is_hidden.any(axis=0))]
        detail = f"markers hidden for long times are left out: {_listed(names)}"
        label = markers.labels[gap.marker]
        cautions += (Caution("markers_left_out", detail, frames=gap.frames, joint=label),)
    return cautions


def stretch_caution(markers: Markers, stretch: slice) -> tuple[Caution, ...]:
    """A caution if only a part of the frames is read."""
    count = len(markers.positions)
    if stretch.stop - stretch.start == count:
        return ()
    first, last = markers.first_frame + stretch.start, markers.first_frame + stretch.stop - 1
    detail = (
        f"markers that are needed are hidden for long times, so only frames {first} to {last} are"
        f" read, which are {last - first + 1} of {count} frames"
    )
    return (Caution("frames_trimmed", detail),)


def _listed(names: Sequence[str]) -> str:
    more = " and others" if len(names) > MAX_MARKERS_SHOWN else ""
    return ", ".join(names[:MAX_MARKERS_SHOWN]) + more
