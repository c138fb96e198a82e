"""Calls: clips. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from kinedex.call import Call, content, nothing, path_of, record
from kinedex.sent import UNSET, FileInput, Progress, Unset, corrections, given
from kinedex.types.choices import ClipState
from kinedex.types.clips import Clip, ClipCreated, ClipList


def list_clips(
    *,
    person: str | Sequence[str] | None = None,
    task: str | Sequence[str] | None = None,
    word: str | Sequence[str] | None = None,
    license: str | Sequence[str] | None = None,
    source: str | Sequence[str] | None = None,
    not_person: str | Sequence[str] | None = None,
    not_task: str | Sequence[str] | None = None,
    not_word: str | Sequence[str] | None = None,
    not_license: str | Sequence[str] | None = None,
    not_source: str | Sequence[str] | None = None,
    min_duration: float | None = None,
    max_duration: float | None = None,
    state: ClipState | None = None,
    q: str | None = None,
    sort: Literal[
        "created_at",
        "-created_at",
        "name",
        "-name",
        "duration",
        "-duration",
        "person",
        "-person",
        "task",
        "-task",
    ]
    | None = None,
    limit: int | None = None,
    cursor: str | None = None,
) -> Call[ClipList]:
    """List the clips that pass every filter. Repeat a label parameter to accept several values.

    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    min_duration: Seconds.
    max_duration: Seconds.
    q: Part of the name.
    sort: A minus sign at the start reverses the order. Default: -created_at.
    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    return Call(
        "list_clips",
        "GET",
        "/v1/clips",
        record(ClipList),
        query=given(
            person=person,
            task=task,
            word=word,
            license=license,
            source=source,
            not_person=not_person,
            not_task=not_task,
            not_word=not_word,
            not_license=not_license,
            not_source=not_source,
            min_duration=min_duration,
            max_duration=max_duration,
            state=state,
            q=q,
            sort=sort,
            limit=limit,
            cursor=cursor,
        ),
    )


def create_clip(
    file: FileInput,
    *,
    skeleton: FileInput | None = None,
    audio: FileInput | None = None,
    name: str | None = None,
    person: str | None = None,
    task: str | None = None,
    words: str | Sequence[str] | None = None,
    license: str | None = None,
    source: str | None = None,
    frame_rate: float | None = None,
    unit: str | None = None,
    roles: Mapping[str, str] | None = None,
    stack: str | None = None,
    audio_offset: float | None = None,
    tempo: float | None = None,
    beats: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> Call[ClipCreated]:
    """Store a clip. A worker analyzes it: then it is `ready`, or `failed` with an `error`.

    file: The motion: BVH, AMC, C3D, FBX, NPZ or NPY.
    skeleton: The ASF file that an AMC file needs.
    audio: The recording that goes with the motion: WAV, FLAC, OGG or MP3.
    name: Default: the file's name.
    words: Separated by spaces. In a phrase, underscores replace spaces.
    frame_rate: It replaces the frame rate that the file declares.
    unit: m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.
    roles: JSON: joint name by role, as in {"hips": "Pelvis"}.
    audio_offset: Time in the motion at which the recording begins, seconds; may be negative.
        Default: estimated.
    tempo: Beats per minute, if known.
    beats: Seconds, separated by spaces. They replace all other beats.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    return Call(
        "create_clip",
        "POST",
        "/v1/clips",
        record(ClipCreated),
        fields=given(
            name=name,
            person=person,
            task=task,
            words=words,
            license=license,
            source=source,
            frame_rate=frame_rate,
            unit=unit,
            roles=roles,
            stack=stack,
            audio_offset=audio_offset,
            tempo=tempo,
            beats=beats,
        ),
        files=given(file=file, skeleton=skeleton, audio=audio),
        progress=progress,
    )


def get_clip(clip_id: str) -> Call[Clip]:
    """One clip."""
    return Call("get_clip", "GET", path_of("/v1/clips/{clip_id}", clip_id=clip_id), record(Clip))


def update_clip(
    clip_id: str,
    *,
    name: str | Unset | None = UNSET,
    person: str | Unset | None = UNSET,
    task: str | Unset | None = UNSET,
    words: Sequence[str] | Unset | None = UNSET,
    license: str | Unset | None = UNSET,
    source: str | Unset | None = UNSET,
    frame_rate: float | Unset | None = UNSET,
    stack: str | Unset | None = UNSET,
    audio_offset: float | Unset | None = UNSET,
    tempo: float | Unset | None = UNSET,
    beats: Sequence[float] | Unset | None = UNSET,
) -> Call[Clip]:
    """Correct the labels or hints of a clip.

    frame_rate: The clip is analyzed again. null restores the declared frame rate.
    stack: The animation stack of an FBX file. The clip is analyzed again. null restores the
        longest stack.
    audio_offset: Time in the motion at which the recording begins, seconds; may be negative. The
        clip is analyzed again. With null, it is estimated.
    tempo: Beats per minute. The clip is analyzed again. null deletes the tempo.
    beats: Seconds. They replace all other beats. The clip is analyzed again. null or an empty
        list deletes them.
    """
    return Call(
        "update_clip",
        "PATCH",
        path_of("/v1/clips/{clip_id}", clip_id=clip_id),
        record(Clip),
        json=corrections(
            name=name,
            person=person,
            task=task,
            words=words,
            license=license,
            source=source,
            frame_rate=frame_rate,
            stack=stack,
            audio_offset=audio_offset,
            tempo=tempo,
            beats=beats,
        ),
    )


def delete_clip(clip_id: str) -> Call[None]:
    """Delete a clip, its file and everything that was computed from it."""
    return Call("delete_clip", "DELETE", path_of("/v1/clips/{clip_id}", clip_id=clip_id), nothing)


def get_file(clip_id: str) -> Call[bytes]:
    """The original file, as an attachment: a browser must not show foreign content as a page."""
    return Call(
        "get_file",
        "GET",
        path_of("/v1/clips/{clip_id}/file", clip_id=clip_id),
        content,
        accept="*/*",
    )


def get_audio(clip_id: str) -> Call[bytes]:
    """The recording that goes with a clip, as an attachment."""
    return Call(
        "get_audio",
        "GET",
        path_of("/v1/clips/{clip_id}/audio", clip_id=clip_id),
        content,
        accept="*/*",
    )


def delete_audio(clip_id: str) -> Call[Clip]:
    """Delete the recording that goes with a clip. The clip is analyzed again."""
    return Call(
        "delete_audio",
        "DELETE",
        path_of("/v1/clips/{clip_id}/audio", clip_id=clip_id),
        record(Clip),
    )
