"""Calls: clips. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from kinedex.call import Call, nothing, path_of, read_bytes, record
from kinedex.sent import UNSET, FileInput, Progress, Unset, corrections, given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.choices import ClipState
    from kinedex.types.clips import Clip, ClipCreated, ClipList
    from kinedex.types.measures import MeasuredClip


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
    folder: str | Sequence[str] | None = None,
    not_folder: str | Sequence[str] | None = None,
    collection: str | Sequence[str] | None = None,
    annotation: str | Sequence[str] | None = None,
    created_after: str | None = None,
    created_before: str | None = None,
    where: Mapping[str, Any] | str | None = None,
    min_duration: float | None = None,
    max_duration: float | None = None,
    min_frame_rate: float | None = None,
    max_frame_rate: float | None = None,
    min_joints: float | None = None,
    max_joints: float | None = None,
    min_travel: float | None = None,
    max_travel: float | None = None,
    min_speed: float | None = None,
    max_speed: float | None = None,
    min_energy: float | None = None,
    max_energy: float | None = None,
    min_tempo: float | None = None,
    max_tempo: float | None = None,
    state: ClipState | None = None,
    missing: Sequence[Literal["person", "task", "words"]] | None = None,
    has_warnings: bool | None = None,
    q: str | None = None,
    sort: str | None = None,
    limit: int | None = None,
    cursor: str | None = None,
    fields: Sequence[str] | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
) -> Call[ClipList]:
    """List the clips that pass every filter. Repeat a label parameter to accept several values.

    `meta.KEY=VALUE` filters by metadata, `not_meta.KEY=VALUE` refuses a value, `meta.KEY.min=30`
    and `meta.KEY.max=40` filter by a number (keys: `GET /v1/metadata`). `measure.NAME.min` and
    `measure.NAME.max` are bounds of a measure of `GET /v1/measures`.

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
    missing: Only clips that lack at least one of these labels.
    has_warnings: true: only clips with warnings; false: only clips without.
    q: Part of the name, of the path, or of a text of the metadata.
    sort: A minus sign at the start reverses the order. Default: -created_at.
    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    filter: Filters by name, as in a search, for those that are no arguments: {"meta.condition":
        "tired", "meta.age.min": 30}.
    """
    from kinedex.types.clips import ClipList

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
            folder=folder,
            not_folder=not_folder,
            collection=collection,
            annotation=annotation,
            created_after=created_after,
            created_before=created_before,
            where=where,
            min_duration=min_duration,
            max_duration=max_duration,
            min_frame_rate=min_frame_rate,
            max_frame_rate=max_frame_rate,
            min_joints=min_joints,
            max_joints=max_joints,
            min_travel=min_travel,
            max_travel=max_travel,
            min_speed=min_speed,
            max_speed=max_speed,
            min_energy=min_energy,
            max_energy=max_energy,
            min_tempo=min_tempo,
            max_tempo=max_tempo,
            state=state,
            missing=missing,
            has_warnings=has_warnings,
            q=q,
            sort=sort,
            limit=limit,
            cursor=cursor,
            fields=fields,
        )
        | given(**(filter or {})),
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
    captions: str | None = None,
    license: str | None = None,
    source: str | None = None,
    metadata: str | Mapping[str, Any] | None = None,
    path: str | None = None,
    on_conflict: Literal["keep", "update", "error"] | None = None,
    frame_rate: float | None = None,
    unit: str | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    roles: str | Mapping[str, Any] | None = None,
    stack: str | None = None,
    audio_offset: float | None = None,
    tempo: float | None = None,
    beats: str | None = None,
    progress: Progress | None = None,
) -> Call[ClipCreated]:
    """Store a clip. A worker analyzes it: then it is `ready`, or `failed` with an `error`.

    If the library has the same bytes already, the answer is their clip. `differences` lists the
    labels and hints that came with other values, and `on_conflict` says what happens to them.

    file: The motion: BVH, AMC, C3D, TRC, FBX, GLB, glTF, VRM, MVNX, NPZ, NPY, CSV of Motive or
        Nexus, TSV of Qualisys, or JSON of 3-D keypoints.
    skeleton: The ASF file that an AMC file needs.
    audio: The recording that goes with the motion: WAV, FLAC, OGG or MP3.
    name: Default: the file's name.
    words: Separated by spaces. In a phrase, underscores replace spaces.
    captions: Sentences that describe the motion, one a line (or separated by |). Their words
        teach the word model like `words`.
    metadata: JSON: values of your own by key, as in {"condition": "fatigued", "age": 30}.
    path: Where the file was, relative to a folder of yours, as in `cmu/02/02_01.bvh`.
    on_conflict: If the library has the same bytes already, with other labels or hints: keep the
        stored values; update them; or answer 409 and change nothing. `differences` lists the
        fields. A field that is not sent stays as it is. Default: keep.
    frame_rate: It replaces the frame rate that the file declares.
    unit: m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.
    up_axis: The axis of the file that points up. Without it, the axis that the file says is
        used, else the one along which the body stands: then the clip has the warning
        `up_axis_guessed`.
    roles: JSON: joint name by role, as in {"hips": "Pelvis"}; a list of two names is for their
        middle, as in {"hips": ["LHip", "RHip"]}. A body that seems to be an animal is refused as
        `skeleton_not_human`, with the reasons, unless roles are sent.
    stack: The name of the animation stack to read, if an FBX file has several; default: the
        longest. The clip's warning `stack_chosen` lists them.
    audio_offset: Time in the motion at which the recording begins, seconds; may be negative.
        Default: estimated.
    tempo: Beats per minute, if known.
    beats: Seconds, separated by spaces, as in `0.5 1.1`. They replace all other beats.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.clips import ClipCreated

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
            captions=captions,
            license=license,
            source=source,
            metadata=metadata,
            path=path,
            on_conflict=on_conflict,
            frame_rate=frame_rate,
            unit=unit,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            audio_offset=audio_offset,
            tempo=tempo,
            beats=beats,
        ),
        files=given(file=file, skeleton=skeleton, audio=audio),
        progress=progress,
    )


def get_clip(clip_id: str, *, fields: Sequence[str] | None = None) -> Call[MeasuredClip]:
    """One clip, with its measures beside those of the library.

    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    """
    from kinedex.types.measures import MeasuredClip

    return Call(
        "get_clip",
        "GET",
        path_of("/v1/clips/{clip_id}", clip_id=clip_id),
        record(MeasuredClip),
        query=given(fields=fields),
    )


def update_clip(
    clip_id: str,
    *,
    name: str | Unset | None = UNSET,
    person: str | Unset | None = UNSET,
    task: str | Unset | None = UNSET,
    words: Sequence[str] | Unset | None = UNSET,
    captions: Sequence[str] | Unset | None = UNSET,
    license: str | Unset | None = UNSET,
    source: str | Unset | None = UNSET,
    metadata: Mapping[str, bool | int | float | str | None] | Unset | None = UNSET,
    frame_rate: float | Unset | None = UNSET,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | Unset | None = UNSET,
    stack: str | Unset | None = UNSET,
    audio_offset: float | Unset | None = UNSET,
    tempo: float | Unset | None = UNSET,
    beats: Sequence[float] | Unset | None = UNSET,
) -> Call[Clip]:
    """Correct the labels or hints of a clip.

    captions: Sentences that describe the motion; they replace all earlier ones.
    metadata: Only the sent keys change. null deletes a key; null instead of the object deletes
        all.
    frame_rate: The clip is analyzed again. null restores the declared frame rate.
    up_axis: The axis of the file that points up. The clip is analyzed again. With null, it is
        found as after an upload.
    stack: The animation stack of an FBX file. The clip is analyzed again. null restores the
        longest stack.
    audio_offset: Time in the motion at which the recording begins, seconds; may be negative. The
        clip is analyzed again. With null, it is estimated.
    tempo: Beats per minute. The clip is analyzed again. null deletes the tempo.
    beats: Seconds. They replace all other beats. The clip is analyzed again. null or an empty
        list deletes them.
    """
    from kinedex.types.clips import Clip

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
            captions=captions,
            license=license,
            source=source,
            metadata=metadata,
            frame_rate=frame_rate,
            up_axis=up_axis,
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
        read_bytes,
        accept="*/*",
    )
