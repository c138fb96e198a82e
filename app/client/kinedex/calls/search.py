"""Calls: search. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.choices import Method
    from kinedex.types.search import MotionHits, WordHits


def search_motion(
    clip_id: str | None = None,
    *,
    fields: Sequence[str] | None = None,
    file: FileInput | None = None,
    skeleton: FileInput | None = None,
    unit: str | None = None,
    frame_rate: float | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    roles: str | Mapping[str, Any] | None = None,
    stack: str | None = None,
    start: float | None = None,
    end: float | None = None,
    method: Method | None = None,
    limit: int | None = None,
    scope: Literal["clips", "windows", "segments"] | None = None,
    tempo: Literal["any", "same"] | None = None,
    max_distance: float | None = None,
    q: int | None = None,
    eta: float | None = None,
    normalized: bool | None = None,
    include_self: bool | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    cursor: str | None = None,
    segment: int | None = None,
    progress: Progress | None = None,
) -> Call[MotionHits]:
    """Find motions like a stored clip, a part of one, or an uploaded file.

    With scope `windows`, find parts of clips, with their start and end. With scope `segments`,
    find motions from one keypose to the next.

    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    file: The query motion, in any format that an upload may have. It is never stored.
    skeleton: The ASF file that an AMC file needs.
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
    start: Start of the queried part, seconds.
    end: End of the queried part, seconds.
    method: Default: fused.
    limit: Maximum number of items in one answer. Default: 10.
    scope: clips: whole clips are compared. windows: parts of clips are found, at any time in a
        clip, by the methods fused, vector and dtw; the query is up to 120 s long. segments:
        motions from one keypose to the next are compared by their vectors; the query is taken as
        one segment. Default: clips.
    tempo: For method fused with scope clips. any: the motion is also found played faster or
        slower, cut, or repeated; of two equal hits, the one at the tempo of the query comes
        first. same: tempo is a part of the motion, and whole clips are compared as they are.
        Default: any.
    max_distance: Only hits whose `distance` is at most this; `limit` and `next` still make
        pages. Units of distances: vector: of motion vectors, Euclidean. dtw: body lengths, the
        mean over aligned frames. fused: of both and of the graph of neighbors; behind the 300
        nearest it goes on from the last of them. msv-dtw: D_dtw (Sun 2011, equation 7).
        msv-xcorr: 3 - D_xcorr (equation 6). metric-*: Euclidean, in learned coordinates.
    q: For methods msv-dtw and msv-xcorr with scope clips: the norm of the distances between
        joints, 1 or 2 (Sun 2011, equation 2). With 1, the volumes of all clips that pass the
        filter are computed for the search, 20 ms each; at most 1000 clips. Default: 2.
    eta: For the same methods: above 0, a cell of a self-similarity matrix is 1 where two joints
        are at most this many body lengths apart, else 0. 0, the paper's choice, keeps the
        distances. It costs as much as q = 1. Default: 0.0.
    normalized: For method msv-xcorr. As printed, D_xcorr of two motions falls with the ratio of
        their lengths: of T and U > T frames, the correlation in time is about sqrt(T / U) at
        most. true: the shorter motion is compared with parts of the longer one as long as it, so
        that a long motion can be like a short one. Default: False.
    include_self: Whether the query clip may be a hit. A file that is stored already counts as
        its clip. With scope windows and segments: whether parts that overlap the query may be
        hits. Default: False.
    segment: With scope segments: the clip's segment of that index is the query.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.search import MotionHits

    return Call(
        "search_motion",
        "POST",
        "/v1/search/motion",
        record(MotionHits),
        query=given(fields=fields),
        json=given(
            clip_id=clip_id,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            start=start,
            end=end,
            method=method,
            limit=limit,
            scope=scope,
            tempo=tempo,
            max_distance=max_distance,
            q=q,
            eta=eta,
            normalized=normalized,
            include_self=include_self,
            filter=filter,
            cursor=cursor,
            segment=segment,
        ),
        fields=given(
            clip_id=clip_id,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            start=start,
            end=end,
            method=method,
            limit=limit,
            scope=scope,
            tempo=tempo,
            max_distance=max_distance,
            q=q,
            eta=eta,
            normalized=normalized,
            include_self=include_self,
            filter=filter,
            cursor=cursor,
            segment=segment,
        ),
        files=given(file=file, skeleton=skeleton),
        progress=progress,
    )


def search_words(
    words: Sequence[str],
    *,
    fields: Sequence[str] | None = None,
    mode: Literal["default", "cca", "printed"] | None = None,
    scope: Literal["clips", "windows", "segments"] | None = None,
    limit: int | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    cursor: str | None = None,
) -> Call[WordHits]:
    """Find motions for words, phrases or sentences. The most probable motion comes first.

    The `score` of a hit is a probability, in both modes.

    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    words: Words, phrases or sentences. Inflected forms and words of the same meaning are
        understood. A word with a minus before it (-left) leaves out the clips that carry it.
    mode: How clips are ranked. default: by a kernel regression from motion features to words.
        cca: by the angle in Takano's correlated space of motion symbols and words, with a ridge
        and with as many dimensions as predict held-out words best. printed: by the distance in
        that space as Takano printed it, with the pseudo-inverse and 10 dimensions. Default:
        default.
    scope: clips: whole clips are ranked. windows: moments are found, at any time in a clip, with
        their start and end. segments: motions from one keypose to the next are ranked. With
        windows and segments, `mode` is default, and a word with a minus leaves out the times at
        which it is likelier than not. Default: clips.
    limit: Maximum number of items in one answer. Default: 10.
    """
    from kinedex.types.search import WordHits

    return Call(
        "search_words",
        "POST",
        "/v1/search/words",
        record(WordHits),
        query=given(fields=fields),
        json=given(words=words, mode=mode, scope=scope, limit=limit, filter=filter, cursor=cursor),
    )
