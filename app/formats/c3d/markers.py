"""The markers of a C3D file that are used: labeled, of one subject, each once, while seen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import Place, Unreadable
from app.formats.c3d.points import Points
from app.motion.roles.marker_names import is_marker, places_of, subject_and_label
from app.motion.skeleton.occlusion import Gap
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import BoolArray, FloatArray

SHOWN_MARKERS = 8
"""As many markers are named in a caution or a refusal."""


@dataclass(frozen=True, slots=True)
class Markers:
    """The markers of one person.

    labels: (markers,) without their subject; positions: (frames, markers, 3), NaN where
    unseen; first_frame: the file's number of the first frame.
    """

    labels: tuple[str, ...]
    positions: FloatArray
    first_frame: int
    cautions: tuple[Caution, ...] = ()


def labeled_markers(points: Points) -> Markers:
    """The markers of one subject that were seen, each label once.

    Frames before the first marker is seen, and after the last, are left out. Raises Unreadable if
    no labeled marker is seen."""
    split = [subject_and_label(label) for label in points.labels]
    outputs = _model_outputs(points)
    named = [
        index
        for index, (_, label) in enumerate(split)
        if is_marker(label) and points.labels[index] not in outputs
    ]
    seen = np.isfinite(points.positions[..., 0])
    named = [index for index in named if seen[:, index].any()]
    if not named:
        message = "expected labeled markers, found none that is seen"
        raise Unreadable(message, places=[Place("POINT:LABELS", message)])
    subject, cautions = _main_subject([split[index] for index in named])
    mine = [index for index in named if split[index][0] == subject]
    chosen_ones, more = _each_once([(split[index][1], index) for index in mine], seen)
    shown = np.flatnonzero(seen[:, chosen_ones].any(axis=1))
    first, last = int(shown[0]), int(shown[-1]) + 1
    if last - first < len(seen):
        detail = f"no marker is seen before frame {points.first_frame + first} or after"
        more += (Caution("frames_trimmed", f"{detail} frame {points.first_frame + last - 1}"),)
    return Markers(
        tuple(split[index][1] for index in chosen_ones),
        points.positions[first:last, chosen_ones],
        points.first_frame + first,
        cautions + more,
    )


def _model_outputs(points: Points) -> set[str]:
    """Labels that the file itself calls angles, forces and the like."""
    groups = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS")
    found = (points.parameters.get(f"POINT:{group}") for group in groups)
    return {label for group in found if group is not None for label in group.texts}


def _main_subject(names: Sequence[tuple[str, str]]) -> tuple[str, tuple[Caution, ...]]:
    """The subject with the most known markers; of equal ones that with the most markers."""
    by_subject: dict[str, list[str]] = {}
    for subject, label in names:
        by_subject.setdefault(subject, []).append(label)
    ranked = sorted(by_subject, key=lambda s: (-len(places_of(by_subject[s])), -len(by_subject[s])))
    others = [subject or "without a name" for subject in ranked[1:]]
    if not others:
        return ranked[0], ()
    detail = f"only subject {ranked[0] or 'without a name'} is read, not: {_listed(others)}"
    return ranked[0], (Caution("several_subjects", detail),)


def _each_once(
    named: Sequence[tuple[str, int]], seen: BoolArray
) -> tuple[list[int], tuple[Caution, ...]]:
    """Of points with the same label, the one that is seen in the most frames."""
    best: dict[str, int] = {}
    for label, index in named:
        held = best.setdefault(label, index)
        if seen[:, index].sum() > seen[:, held].sum():
            best[label] = index
    counts = Counter(label for label, _ in named)
    twice = [label for label, count in counts.items() if count > 1]
    if not twice:
        return list(best.values()), ()
    detail = f"several points have the same label, the one seen most is read: {_listed(twice)}"
    return list(best.values()), (Caution("duplicate_names", detail),)


def hidden_too_long(markers: Markers, gaps: Sequence[Gap]) -> Unreadable:
    """The error with the markers and frames of gaps."""
    places = []
    for gap in gaps[:SHOWN_MARKERS]:
        first, last = markers.first_frame + gap.start, markers.first_frame + gap.end - 1
        where = f"marker {markers.labels[gap.marker]}, frames {first} to {last}"
        places.append(Place(where, f"expected the marker, found it hidden for {last - first + 1}"))
    detail = "; ".join(place.location for place in places)
    return Unreadable(f"Markers are hidden for too long to be filled in: {detail}", places=places)


def gap_cautions(markers: Markers, filled: int, gaps: Sequence[Gap]) -> tuple[Caution, ...]:
    """What was filled in (frames of markers), and what was left out for its long gaps."""
    cautions: tuple[Caution, ...] = ()
    if filled:
        share = 100 * filled / (len(markers.labels) * len(markers.positions))
        detail = f"markers hidden for short times were filled in: {share:.1f} % of their frames"
        cautions += (Caution("gaps_filled", detail),)
    if gaps:
        names = list(dict.fromkeys(markers.labels[gap.marker] for gap in gaps))
        detail = f"markers hidden for long times are left out: {_listed(names)}"
        cautions += (Caution("markers_left_out", detail),)
    return cautions


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN_MARKERS]) + (" and others" if len(names) > SHOWN_MARKERS else "")
