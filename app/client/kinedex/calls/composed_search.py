"""Calls: composed search. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter, SearchExample, SearchPoses, SearchRhythm
    from kinedex.types.choices import BodyPart, GroupBy, Method
    from kinedex.types.composed_search import ComposedHits
    from kinedex.types.why import HitReasons


def search_parts(
    *,
    fields: Sequence[str] | None = None,
    file: FileInput | None = None,
    skeleton: FileInput | None = None,
    method: Method | None = None,
    mode: Literal["default", "cca", "printed"] | None = None,
    limit: int | None = None,
    include_self: bool | None = None,
    poses: SearchPoses | None = None,
    rhythm: SearchRhythm | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    group_by: GroupBy | None = None,
    group: str | None = None,
    diversity: float | None = None,
    min_score: float | None = None,
    facets: Sequence[str] | None = None,
    cursor: str | None = None,
    examples: Sequence[SearchExample] | None = None,
    words: Sequence[str] | None = None,
    start: float | None = None,
    end: float | None = None,
    weight: float | None = None,
    against: bool | None = None,
    body_part: BodyPart | None = None,
    unit: str | None = None,
    frame_rate: float | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    roles: str | Mapping[str, Any] | None = None,
    stack: str | None = None,
    progress: Progress | None = None,
) -> Call[ComposedHits]:
    """Find motions by several parts together, for something or against it.

    Parts are examples, words, poses in order, and a rhythm. A clip is a good hit if it is like
    every example that is for something, carries the words, and is like no example that is
    against something. Each hit tells what each part contributed.

    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    file: The query motion, in any format that an upload may have. It is never stored.
    skeleton: The ASF file that an AMC file needs.
    method: How examples are compared. fused, dtw, msv-dtw and msv-xcorr are exact for the 300
        clips that fit best by vectors and words; the others follow in that order. One example
        alone is compared with every clip, as in a search by example. Default: fused.
    mode: How clips are ranked by words, as in a search by words. Default: default.
    limit: Maximum number of items in one answer. Default: 10.
    include_self: Whether the examples' clips may be hits. Default: False.
    poses: Poses that hits take, one after the other.
    rhythm: A rhythm in which hits move.
    group_by: Show only the best hit of each group: by person, task, source, or near-duplicates
        (`GET /v1/duplicates`). With this, `diversity`, `min_score` or `facets`, one part alone
        is scored as one of several: by a probability, and one example at its own tempo.
    group: With group_by: the hits of this group, by the `value` of an earlier answer.
    diversity: Above 0, the 300 best hits are put in an order in which neighbors are unlike each
        other (maximal marginal relevance): next is the hit with the largest (1 - diversity) x
        score - diversity x likeness to the hits before it. The ranking ends after them. Default:
        0.0.
    min_score: Only hits with at least this score, a probability. Default: 0.0.
    facets: Count over all hits: person, task, source, license, folder, word, or the quartiles of
        a measure by its name (`GET /v1/measures`, or duration, speed, ...). Default: [].
    examples: Motions that hits are like, or are not like. Default: [].
    words: Words, phrases or sentences, as in a search by words. Together they count like one
        example of weight 1. A word with a minus before it (-left) leaves out the clips that
        carry it. Default: [].
    start: Start of the part of the file, seconds.
    end: End of the part of the file, seconds.
    weight: How much it counts, relative to the others. Default: 1.0.
    against: Whether hits must not be like the file. Default: False.
    body_part: The part of the file's body that counts.
    unit: m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.
    frame_rate: It replaces the frame rate that the file declares.
    up_axis: The axis of the file that points up. Without it, the axis that the file says is
        used, else the one along which the body stands: then the clip has the warning
        `up_axis_guessed`.
    roles: JSON: joint name by role, as in {"hips": "Pelvis"}; a list of two names is for their
        middle, as in {"hips": ["LHip", "RHip"]}. A body that seems to be an animal is refused as
        `skeleton_not_human`, with the reasons, unless roles are sent.
    stack: The name of the animation stack to read, if an FBX file has several; default: the
        longest. The clip's warning `stack_chosen` lists them.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.composed_search import ComposedHits

    return Call(
        "search_parts",
        "POST",
        "/v1/search",
        record(ComposedHits),
        query=given(fields=fields),
        json=given(
            method=method,
            mode=mode,
            limit=limit,
            include_self=include_self,
            poses=poses,
            rhythm=rhythm,
            filter=filter,
            group_by=group_by,
            group=group,
            diversity=diversity,
            min_score=min_score,
            facets=facets,
            cursor=cursor,
            examples=examples,
            words=words,
            start=start,
            end=end,
            weight=weight,
            against=against,
            body_part=body_part,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
        ),
        fields=given(
            method=method,
            mode=mode,
            limit=limit,
            include_self=include_self,
            poses=poses,
            rhythm=rhythm,
            filter=filter,
            group_by=group_by,
            group=group,
            diversity=diversity,
            min_score=min_score,
            facets=facets,
            cursor=cursor,
            examples=examples,
            words=words,
            start=start,
            end=end,
            weight=weight,
            against=against,
            body_part=body_part,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
        ),
        files=given(file=file, skeleton=skeleton),
        progress=progress,
    )


def explain_search(
    hit: str,
    *,
    file: FileInput | None = None,
    skeleton: FileInput | None = None,
    method: Method | None = None,
    mode: Literal["default", "cca", "printed"] | None = None,
    limit: int | None = None,
    include_self: bool | None = None,
    poses: SearchPoses | None = None,
    rhythm: SearchRhythm | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    group_by: GroupBy | None = None,
    group: str | None = None,
    diversity: float | None = None,
    min_score: float | None = None,
    facets: Sequence[str] | None = None,
    cursor: str | None = None,
    examples: Sequence[SearchExample] | None = None,
    words: Sequence[str] | None = None,
    start: float | None = None,
    end: float | None = None,
    weight: float | None = None,
    against: bool | None = None,
    body_part: BodyPart | None = None,
    unit: str | None = None,
    frame_rate: float | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    roles: str | Mapping[str, Any] | None = None,
    stack: str | None = None,
    progress: Progress | None = None,
) -> Call[HitReasons]:
    """Why a clip is a hit of a search by several parts: what each part says, when and where.

    The body is that of `POST /v1/search`, and `hit`. For each example, both motions are aligned:
    times that belong together, and how far each joint is apart. For words, a curve over time.

    file: The query motion, in any format that an upload may have. It is never stored.
    skeleton: The ASF file that an AMC file needs.
    method: How examples are compared. fused, dtw, msv-dtw and msv-xcorr are exact for the 300
        clips that fit best by vectors and words; the others follow in that order. One example
        alone is compared with every clip, as in a search by example. Default: fused.
    mode: How clips are ranked by words, as in a search by words. Default: default.
    limit: Maximum number of items in one answer. Default: 10.
    include_self: Whether the examples' clips may be hits. Default: False.
    poses: Poses that hits take, one after the other.
    rhythm: A rhythm in which hits move.
    group_by: Show only the best hit of each group: by person, task, source, or near-duplicates
        (`GET /v1/duplicates`). With this, `diversity`, `min_score` or `facets`, one part alone
        is scored as one of several: by a probability, and one example at its own tempo.
    group: With group_by: the hits of this group, by the `value` of an earlier answer.
    diversity: Above 0, the 300 best hits are put in an order in which neighbors are unlike each
        other (maximal marginal relevance): next is the hit with the largest (1 - diversity) x
        score - diversity x likeness to the hits before it. The ranking ends after them. Default:
        0.0.
    min_score: Only hits with at least this score, a probability. Default: 0.0.
    facets: Count over all hits: person, task, source, license, folder, word, or the quartiles of
        a measure by its name (`GET /v1/measures`, or duration, speed, ...). Default: [].
    examples: Motions that hits are like, or are not like. Default: [].
    words: Words, phrases or sentences, as in a search by words. Together they count like one
        example of weight 1. A word with a minus before it (-left) leaves out the clips that
        carry it. Default: [].
    start: Start of the part of the file, seconds.
    end: End of the part of the file, seconds.
    weight: How much it counts, relative to the others. Default: 1.0.
    against: Whether hits must not be like the file. Default: False.
    body_part: The part of the file's body that counts.
    unit: m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.
    frame_rate: It replaces the frame rate that the file declares.
    up_axis: The axis of the file that points up. Without it, the axis that the file says is
        used, else the one along which the body stands: then the clip has the warning
        `up_axis_guessed`.
    roles: JSON: joint name by role, as in {"hips": "Pelvis"}; a list of two names is for their
        middle, as in {"hips": ["LHip", "RHip"]}. A body that seems to be an animal is refused as
        `skeleton_not_human`, with the reasons, unless roles are sent.
    stack: The name of the animation stack to read, if an FBX file has several; default: the
        longest. The clip's warning `stack_chosen` lists them.
    hit: Id of the clip to explain.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.why import HitReasons

    return Call(
        "explain_search",
        "POST",
        "/v1/search/why",
        record(HitReasons),
        json=given(
            method=method,
            mode=mode,
            limit=limit,
            include_self=include_self,
            poses=poses,
            rhythm=rhythm,
            filter=filter,
            group_by=group_by,
            group=group,
            diversity=diversity,
            min_score=min_score,
            facets=facets,
            cursor=cursor,
            examples=examples,
            words=words,
            start=start,
            end=end,
            weight=weight,
            against=against,
            body_part=body_part,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            hit=hit,
        ),
        fields=given(
            method=method,
            mode=mode,
            limit=limit,
            include_self=include_self,
            poses=poses,
            rhythm=rhythm,
            filter=filter,
            group_by=group_by,
            group=group,
            diversity=diversity,
            min_score=min_score,
            facets=facets,
            cursor=cursor,
            examples=examples,
            words=words,
            start=start,
            end=end,
            weight=weight,
            against=against,
            body_part=body_part,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            hit=hit,
        ),
        files=given(file=file, skeleton=skeleton),
        progress=progress,
    )
