"""Answers: why. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Array, Record
from kinedex.types.alignment import Peak
from kinedex.types.choices import JointRole


@dataclass(frozen=True, slots=True, eq=False)
class ExampleAlignment(Record):
    """An example (first) and the hit (second) along the path that warps one onto the other.

    distance: Mean cost of a step. A search with `method=dtw` has the same distance.
    body_lengths: Meters: torso, neck to head, and shin. Both bodies are scaled to the mean of
    these two lengths before their joints are compared.
    path: (steps, 2): seconds from the start of the first and of the second clip. Neither ever
    falls.
    joints: The 13 joints of figure 2 in Sun 2011.
    differences: (steps, joints), meters: distance of the joint of one body from the same joint
    of the other, with the hips of both at one place and both turned the same way.
    mean_differences: (joints,) mean over the steps, meters.
    peaks: Moments of greatest mean difference, at least 0.5 s apart, greatest first.
    seconds: Seconds between two frames of the first and of the second motion that were
    compared: 0.1, and more for a motion of more than 600 frames.
    """

    distance: float
    body_lengths: list[float]
    path: Array
    joints: list[JointRole]
    differences: Array
    mean_differences: Array
    peaks: list[Peak]
    seconds: list[float]


@dataclass(frozen=True, slots=True)
class PoseMoment(Record):
    """When a hit is nearest to a pose of a sequence.

    time: Seconds from the start of the hit.
    distance: Root mean square distance of the joints, body lengths.
    """

    time: float
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class WordCurve(Record):
    """How probable words are over the time of a hit.

    times: (points,) seconds, evenly spaced; at most 1200.
    values: (points,)
    """

    times: Array
    values: Array


@dataclass(frozen=True, slots=True)
class HitReason(Record):
    """What one part of a query says about a hit.

    part: The part of the query: `examples.0` for the first example, `file` for the uploaded
    one, `poses`, `rhythm`, `words.0` for the first word.
    against: Whether the query is against it.
    score: Probability that the clip is like the example, or carries the words. For examples it
    comes from the distance, relative to the median distance in the library, by a curve that was
    fitted on real clips. Rounded to 4 decimals, because the calibration is not more exact. 0
    means very unlikely, not impossible.
    cost: What the part adds to the `distance` of the hit: of the 300 clips that are compared
    exactly, the costs of all parts sum to the distance. What several examples for something, or
    several words, cost together is divided in proportion to -ln(score) of each.
    weight: The weight of the part. All words together have 1, in equal shares.
    alignment: Of an example; null for words. It shows which joints and which moments agree or
    differ: `differences` is small where they agree.
    curve: Of words: when they are probable, from windows of 2 and 4 s. null for examples, and
    for a clip without windows.
    poses: Of `poses`: one for each, in their order.
    cycles_per_minute: Of `rhythm`: those of the hit; null if it does not repeat itself.
    """

    part: str
    against: bool
    score: float
    cost: float
    weight: float
    alignment: ExampleAlignment | None
    curve: WordCurve | None
    poses: list[PoseMoment] | None
    cycles_per_minute: float | None


@dataclass(frozen=True, slots=True)
class HitReasons(Record):
    """Why a clip is a hit.

    rank: null if the clip is not among the first 300 hits, or does not pass the filter. Score
    and distance are then those that it has alone.
    """

    method: str
    clip_id: str
    rank: int | None
    score: float
    distance: float
    parts: list[HitReason]
