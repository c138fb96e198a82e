"""Why a clip is a hit of a search by several parts: when and where it is like each of them.

For an example, both motions are warped onto each other, and the joints are compared at each step.
For words, a curve says how probable they are over the time of the clip. Each part also has its
probability, and what it adds to the distance of the hit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray
from app.search.composed.pose_sequence import frame_distances, sequence_match
from app.search.example.fusion import SHORTLIST
from app.search.pose.by_pose import POSITIONS
from app.search.windows.moments import STEP
from app.services.comparison.alignment import COMPARED, AlignedClips, Side, align_sides, side_of
from app.services.fields import bad_field
from app.services.find.by_parts import find_by_parts
from app.services.find.criteria import POSES, RHYTHM, pose_vectors
from app.services.find.hits import Hit, Hits, PartScore
from app.services.find.queries import ComposedQuery, Example, PoseSequence, Rhythm
from app.services.find.query import describe
from app.services.find.query_source import QuerySource
from app.services.find.words_in_parts import word_curves
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.files.files import Readable

WORDS = "words."
MAX_STEPS = 600
"""The most frames of a motion that are aligned: a minute at 10 Hz. Of a longer one, every second,
third, ... frame is taken. An alignment of two such motions takes about 30 ms."""

MAX_POINTS = 1200
"""The most points of a curve of words: five minutes. Of a longer one, every second, ... is taken.
"""


@dataclass(frozen=True, slots=True)
class Curve:
    """How probable words are over time: times (k,) in seconds and values (k,) 0..1."""

    times: FloatArray
    values: FloatArray


@dataclass(frozen=True, slots=True)
class PoseMatch:
    """When a hit is nearest to a pose. time: seconds; distance: RMS of the joints, body lengths."""

    time: float
    distance: float


@dataclass(frozen=True, slots=True)
class Reason:
    """What one part of a query says about a hit.

    weight: of the part in the query; that of a text is its share of the weight 1 of all words.
    alignment: of an example (first) with the hit (second), with the seconds between two frames of
    each, which grow with their lengths. curve: of words; None if no window was analyzed. poses: of
    a sequence of poses, in order. cycles_per_minute: of the hit, for a rhythm; None if it has none.
    """

    score: PartScore
    weight: float
    alignment: AlignedClips | None = None
    seconds: tuple[float, float] | None = None
    curve: Curve | None = None
    poses: tuple[PoseMatch, ...] | None = None
    cycles_per_minute: float | None = None


@dataclass(frozen=True, slots=True)
class Why:
    """Why a clip is a hit. rank: from 1, None behind the first SHORTLIST hits."""

    method: str
    clip: ClipRecord
    rank: int | None
    score: float
    distance: float
    reasons: tuple[Reason, ...]


def explain_hit(lib: Library, query: ComposedQuery, clip_id: str) -> Why:
    """Why the clip is a hit of a query, or how good a hit it would be without the filter.

    The limit and the cursor of the query do not matter. Raises what `find_by_parts` raises,
    ClipNotFound and ClipNotReady, and BadField for a clip that cannot be a hit: one that carries a
    word with a minus, or that the model of words does not know.
    """
    clip, query = ready_clip(lib, clip_id), _readable_again(lib, query)
    found, hit, rank = _hit(lib, query, clip_id)
    examples = {example.part: example for example in query.examples}
    theirs = side_of(lib, describe(lib, QuerySource(clip_id), COMPARED)) if examples else None
    texts = sum(part.part.startswith(WORDS) for part in hit.parts)
    reasons = []
    for part in hit.parts:
        example = examples.get(part.part)
        if example is not None and theirs is not None:
            reasons.append(_of_example(lib, part, example, theirs))
        elif part.part == POSES and query.poses is not None:
            reasons.append(_of_poses(lib, part, query.poses, clip_id))
        elif part.part == RHYTHM and query.rhythm is not None:
            reasons.append(_of_rhythm(lib, part, query.rhythm, clip_id))
        else:
            reasons.append(_of_text(lib, part, query.words, clip_id, 1.0 / texts))
    return Why(found.method, clip, rank, hit.score, hit.distance, tuple(reasons))


class _Kept:
    """An upload that is read from its start each time: the search and the reasons both need it."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    def read(self, size: int = -1, /) -> bytes:
        return self._data if size < 0 else self._data[:size]


def _readable_again(lib: Library, query: ComposedQuery) -> ComposedQuery:
    most = lib.settings.max_upload_bytes + 1

    def kept(file: Readable | None) -> _Kept | None:
        return None if file is None else _Kept(file.read(most))

    examples = [
        replace(
            one,
            source=replace(
                one.source, content=kept(one.source.content), skeleton=kept(one.source.skeleton)
            ),
        )
        for one in query.examples
    ]
    return replace(query, examples=examples)


def _hit(lib: Library, query: ComposedQuery, clip_id: str) -> tuple[Hits, Hit, int | None]:
    """The page on which the hit is, the hit, and its rank."""
    first = replace(query, limit=SHORTLIST, cursor=None, clip_fields=frozenset())
    found = find_by_parts(lib, first)
    for hit in found.items:
        if hit.clip.id == clip_id:
            return found, hit, hit.rank
    alone = replace(first, filter=ClipFilter(ids=(clip_id,)), include_self=True)
    found = find_by_parts(lib, alone)
    if not found.items:
        raise bad_field("hit", "the words of the query leave this clip out")
    return found, found.items[0], None


def _of_example(lib: Library, part: PartScore, example: Example, theirs: Side) -> Reason:
    own = side_of(lib, describe(lib, example.source, COMPARED))
    ours, theirs = own.thinned(MAX_STEPS), theirs.thinned(MAX_STEPS)
    seconds = (ours.seconds, theirs.seconds)
    return Reason(part, example.weight, align_sides(ours, theirs), seconds)


def _of_poses(lib: Library, part: PartScore, asked: PoseSequence, clip_id: str) -> Reason:
    positions = describe(lib, QuerySource(clip_id), (POSITIONS,)).arrays[POSITIONS]
    poses, _ = pose_vectors(lib, asked.poses)
    distances = frame_distances(positions, poses.astype(np.float64))
    _, frames = sequence_match(distances)
    matches = tuple(
        PoseMatch(frame / ANALYSIS_RATE, float(distances[place, frame]))
        for place, frame in enumerate(frames)
    )
    return Reason(part, asked.weight, poses=matches)


def _of_rhythm(lib: Library, part: PartScore, asked: Rhythm, clip_id: str) -> Reason:
    labels = lib.index.state[1].labels
    number = labels.numbers(np.array([clip_id], dtype=object))[0]
    seconds = float(labels.measured("cycle_time")[number])
    return Reason(part, asked.weight, cycles_per_minute=60.0 / seconds if seconds > 0.0 else None)


def _of_text(
    lib: Library, part: PartScore, texts: Sequence[str], clip_id: str, weight: float
) -> Reason:
    fitted = lib.models.words(lib.store)
    text = texts[int(part.part.partition(".")[2])]
    # of a text with a minus, the curve of what it leaves out
    asked = fitted.model.ask([text.lstrip("-") if part.is_against else text])
    if not asked.items:
        return Reason(part, weight)
    curves = word_curves(lib, fitted, asked, ClipFilter(ids=(clip_id,)))
    stride = max(1, -(-len(curves.values) // MAX_POINTS))
    times = (np.arange(len(curves.values)) + 0.5) * STEP
    curve = Curve(times[::stride], curves.values[::stride]) if len(curves.values) else None
    return Reason(part, weight, curve=curve)
