"""What makes two clips near-duplicates: the kinds of pairs, and the limits of the evidence.

The limits were chosen on half of the persons of the real clips, with planted copies, and judged on
the other half (tests/bench/test_curation.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from app.search.duplicates.overlay import Overlay


class PairKind(StrEnum):
    """How two clips are alike. All but `similar` are the same take."""

    EXACT = "exact"
    """The same poses at the same times."""
    COPY = "copy"
    """The same take with small differences, such as noise or another cleaning."""
    RATE = "rate"
    """The same take at another frame rate."""
    FORMAT = "format"
    """The same take in another format or with another skeleton."""
    CUT = "cut"
    """One clip is a part of the other, or both are parts of one take."""
    MIRROR = "mirror"
    """The same take with left and right exchanged; it may be cut too."""
    SIMILAR = "similar"
    """Almost the same motion, from another take."""


EXACT = 0.01
"""Distance of an overlay up to which poses are the same but for rounding."""

SAME_TIME = 0.15
"""Seconds by which lengths and starts of whole copies may differ."""

SAME = 0.044
"""The largest distance of copies, whole or cut. Takes that an actor repeats reach .04."""

NOISY, MAX_DRIFT = 0.075, 0.12
"""The largest distance of a whole copy whose difference is noise, and the largest drift of noise.
Takes of people differ slowly."""

OTHER_SKELETON, MIN_OTHER, SHORT_OTHER = 0.2, 2.0, 0.1
"""The largest distance of a whole copy with another skeleton; the seconds from which it holds, and
the largest distance of shorter ones."""

SAME_POSE, OTHER_POSE = 0.06, 0.15
"""Body lengths between the mean poses: of the same skeleton, and of the same take in another."""

SAME_RATE = 0.01
"""The share by which frame rates may differ."""

PART_OVERLAP = 0.93
"""The share of the shorter clip that a cut overlaps."""

MIN_PART = 1.0
"""Seconds of a cut. A shorter piece of a walk is in every walk."""

MAX_SIMILAR = 0.5
"""The largest distance of a pair that is stored. Lists have their own threshold below it."""


@dataclass(frozen=True, slots=True)
class ClipFacts:
    """What a kind depends on. duration: seconds; frame_rate: Hz; joints: of the skeleton."""

    duration: float
    frame_rate: float
    format: str
    joints: int


def kind_of(
    one: ClipFacts, other: ClipFacts, overlay: Overlay, *, is_mirrored: bool
) -> PairKind | None:
    """The kind of a pair from its best overlay; None if they are no near-duplicates."""
    is_whole = abs(one.duration - other.duration) <= SAME_TIME and abs(overlay.shift) <= SAME_TIME
    is_same = _is_whole_copy(one, other, overlay) if is_whole else _is_part(one, other, overlay)
    if not is_same:
        return None if overlay.distance > MAX_SIMILAR or is_mirrored else PairKind.SIMILAR
    if is_mirrored:
        return PairKind.MIRROR
    if not is_whole:
        return PairKind.CUT
    if _differ(one, other):
        return PairKind.FORMAT
    if abs(one.frame_rate - other.frame_rate) > SAME_RATE * one.frame_rate:
        return PairKind.RATE
    return PairKind.EXACT if overlay.distance <= EXACT else PairKind.COPY


def _differ(one: ClipFacts, other: ClipFacts) -> bool:
    """Whether format or skeleton differ."""
    return (one.format, one.joints) != (other.format, other.joints)


def _is_whole_copy(one: ClipFacts, other: ClipFacts, overlay: Overlay) -> bool:
    if overlay.offset > SAME_POSE:
        limit = OTHER_SKELETON if overlay.seconds >= MIN_OTHER else SHORT_OTHER
        is_near = overlay.distance <= limit and overlay.offset <= OTHER_POSE
        return _differ(one, other) and is_near
    is_noise = abs(overlay.drift) <= MAX_DRIFT and overlay.distance <= NOISY
    return overlay.distance <= SAME or is_noise


def _is_part(one: ClipFacts, other: ClipFacts, overlay: Overlay) -> bool:
    shorter = min(one.duration, other.duration)
    return (
        overlay.distance <= SAME
        and overlay.offset <= SAME_POSE
        and overlay.seconds >= max(PART_OVERLAP * shorter, MIN_PART)
    )
