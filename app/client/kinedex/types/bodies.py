"""Objects that calls send. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, NotRequired, TypedDict

from kinedex.types.choices import BodyPart, EditKind, GroupBy, Method


class AcceptedSpan(TypedDict):
    """The part of a suggestion that is accepted.

    start: Start of the part, seconds from the start of the clip.
    end: End of the part, seconds.
    """

    start: float
    end: float


class CollectionItemForm(TypedDict):
    """A clip, or a part of it, to add to a collection.

    start: Start of the part, seconds.
    end: End of the part, seconds.
    """

    clip_id: str
    start: NotRequired[float | None]
    end: NotRequired[float | None]
    notes: NotRequired[str]


class Filter(TypedDict):
    """Filters of the clips before they are ranked. A clip must pass all given filters.

    `meta.KEY=VALUE` filters by the metadata of the clips, `not_meta.KEY=VALUE` leaves clips with
    that value out, and `meta.KEY.min=30`, `meta.KEY.max=40` filter by a number.
    `measure.NAME.min` and `measure.NAME.max` are bounds of a measure of `GET /v1/measures`, as in
    `measure.foot_skate.max=0.1`.

    task: Kinds of it too, as of a word (`/v1/labels/tree`); none with = before it.
    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    folder: Clips whose files were in this folder of an import, or below it.
    not_folder: Clips of none of these folders.
    collection: Ids of collections: clips in any of them.
    annotation: Words: clips with an annotation that has any of them, or a kind of it.
    created_after: Clips that came at this time or later, ISO 8601; UTC without a zone.
    created_before: Clips that came before this time.
    where: A tree of filters, as JSON: {"any_of": [{"task": "walk"}, {"none_of": [{"person":
    "ada"}]}]}. `all_of`, `any_of` and `none_of` are arrays of filters with the keys of this
    one; at most 5 inside each other, and 50 in all.
    min_duration: Seconds.
    max_duration: Seconds.
    min_frame_rate: Frames per second.
    max_frame_rate: Frames per second.
    min_joints: Number of joints.
    max_joints: Number of joints.
    min_travel: Meters that the hips travel over the floor, forth and back.
    max_travel: Meters that the hips travel over the floor, forth and back.
    min_speed: Mean speed of the hips over the floor, meters per second.
    max_speed: Mean speed of the hips over the floor, meters per second.
    min_energy: Mean energy: root mean square speed of the joints, body lengths per second.
    max_energy: Mean energy: root mean square speed of the joints, body lengths per second.
    min_tempo: Beats per minute.
    max_tempo: Beats per minute.
    """

    person: NotRequired[str | Sequence[str] | None]
    task: NotRequired[str | Sequence[str] | None]
    word: NotRequired[str | Sequence[str] | None]
    license: NotRequired[str | Sequence[str] | None]
    source: NotRequired[str | Sequence[str] | None]
    not_person: NotRequired[str | Sequence[str] | None]
    not_task: NotRequired[str | Sequence[str] | None]
    not_word: NotRequired[str | Sequence[str] | None]
    not_license: NotRequired[str | Sequence[str] | None]
    not_source: NotRequired[str | Sequence[str] | None]
    folder: NotRequired[str | Sequence[str] | None]
    not_folder: NotRequired[str | Sequence[str] | None]
    collection: NotRequired[str | Sequence[str] | None]
    annotation: NotRequired[str | Sequence[str] | None]
    created_after: NotRequired[str | None]
    created_before: NotRequired[str | None]
    where: NotRequired[Mapping[str, Any] | str | None]
    min_duration: NotRequired[float | None]
    max_duration: NotRequired[float | None]
    min_frame_rate: NotRequired[float | None]
    max_frame_rate: NotRequired[float | None]
    min_joints: NotRequired[float | None]
    max_joints: NotRequired[float | None]
    min_travel: NotRequired[float | None]
    max_travel: NotRequired[float | None]
    min_speed: NotRequired[float | None]
    max_speed: NotRequired[float | None]
    min_energy: NotRequired[float | None]
    max_energy: NotRequired[float | None]
    min_tempo: NotRequired[float | None]
    max_tempo: NotRequired[float | None]


class SearchExample(TypedDict):
    """A stored clip, or a part of it, that hits must be like, or must not be like.

    start: Start of the part, seconds.
    end: End of the part, seconds.
    weight: How much it counts, relative to the others.
    against: Whether hits must not be like it.
    body_part: The part of the body that counts; by default all of it. Arms: elbows and hands;
    legs: knees and feet; upper_body: all above the hips. It is compared by warping.
    """

    clip_id: str
    start: NotRequired[float | None]
    end: NotRequired[float | None]
    weight: NotRequired[float]
    against: NotRequired[bool]
    body_part: NotRequired[BodyPart | None]


class SearchPose(TypedDict):
    """A pose: of a stored clip at a time, or 13 positions, as in a search by pose.

    time: Seconds from the start of the clip.
    positions: As in `POST /v1/search/pose`.
    """

    clip_id: NotRequired[str | None]
    time: NotRequired[float | None]
    positions: NotRequired[Sequence[Sequence[float]] | None]


class SearchPoses(TypedDict):
    """Poses that hits take one after the other: "from this to that".

    weight: How much it counts, relative to the others.
    against: Whether hits must not take them.
    """

    sequence: Sequence[SearchPose]
    weight: NotRequired[float]
    against: NotRequired[bool]


class SearchRhythm(TypedDict):
    """A rhythm in which hits move: a walk has about 55 cycles, or 110 steps, a minute.

    cycles_per_minute: Of the poses; half of it fits too, since a measured cycle may be two.
    tolerance: A share of it at which the score is halved.
    weight: How much it counts, relative to the others.
    against: Whether hits must not move in it.
    """

    cycles_per_minute: float
    tolerance: NotRequired[float]
    weight: NotRequired[float]
    against: NotRequired[bool]


class ComposedSearch(TypedDict):
    """Find motions by examples and words together; one of them must be for something.

    method: How examples are compared. fused, dtw, msv-dtw and msv-xcorr are exact for the 300
    clips that fit best by vectors and words; the others follow in that order. One example alone
    is compared with every clip, as in a search by example.
    mode: How clips are ranked by words, as in a search by words.
    limit: Maximum number of items in one answer.
    include_self: Whether the examples' clips may be hits.
    poses: Poses that hits take, one after the other.
    rhythm: A rhythm in which hits move.
    group_by: Show only the best hit of each group: by person, task, source, or near-duplicates
    (`GET /v1/duplicates`). With this, `diversity`, `min_score` or `facets`, one part alone is
    scored as one of several: by a probability, and one example at its own tempo.
    group: With group_by: the hits of this group, by the `value` of an earlier answer.
    diversity: Above 0, the 300 best hits are put in an order in which neighbors are unlike each
    other (maximal marginal relevance): next is the hit with the largest (1 - diversity) x score
    - diversity x likeness to the hits before it. The ranking ends after them.
    min_score: Only hits with at least this score, a probability.
    facets: Count over all hits: person, task, source, license, folder, word, or the quartiles
    of a measure by its name (`GET /v1/measures`, or duration, speed, ...).
    examples: Motions that hits are like, or are not like.
    words: Words, phrases or sentences, as in a search by words. Together they count like one
    example of weight 1. A word with a minus before it (-left) leaves out the clips that carry
    it.
    """

    method: NotRequired[Method]
    mode: NotRequired[Literal["default", "cca", "printed"]]
    limit: NotRequired[int]
    include_self: NotRequired[bool]
    poses: NotRequired[SearchPoses | None]
    rhythm: NotRequired[SearchRhythm | None]
    filter: NotRequired[Filter | Mapping[str, Any] | None]
    group_by: NotRequired[GroupBy | None]
    group: NotRequired[str | None]
    diversity: NotRequired[float]
    min_score: NotRequired[float]
    facets: NotRequired[Sequence[str]]
    cursor: NotRequired[str | None]
    examples: NotRequired[Sequence[SearchExample]]
    words: NotRequired[Sequence[str]]


class NewAnnotation(TypedDict):
    """What is said about a part of a clip. It has words, a person or a text.

    start: Start of the part, seconds from the start of the clip.
    end: End of the part, seconds.
    words: What happens in the part. A phrase is one word, joined by underscores (`left_leg`).
    person: Who moves in the part, if it is not the person of the clip.
    text: A sentence that describes the part.
    by: Who said it.
    """

    start: float
    end: float
    words: NotRequired[Sequence[str]]
    person: NotRequired[str | None]
    text: NotRequired[str | None]
    by: NotRequired[str | None]


class Step(TypedDict):
    """One step of an edit.

    kind: cut: keep the part from `start` to `end`. mirror: exchange left and right, also in the
    labels. resample: another frame rate, `fps`. in_place: remove the horizontal path of the
    hips. loop: keep the best loop, with its end blended into its beginning.
    start: Of a cut: seconds of the motion before this step; default: its start.
    end: Of a cut: seconds; default: the end.
    fps: Of resample: frames per second.
    min_seconds: Of a loop: the shortest; default: 0.5 s.
    max_seconds: Of a loop: the longest; default: any.
    """

    kind: EditKind
    start: NotRequired[float | None]
    end: NotRequired[float | None]
    fps: NotRequired[float | None]
    min_seconds: NotRequired[float | None]
    max_seconds: NotRequired[float | None]
