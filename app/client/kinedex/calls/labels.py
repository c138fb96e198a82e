"""Calls: labels. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from kinedex.call import Call, nothing, path_of, read_bytes, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.labels import FolderList, MetadataKeys, NamedCounts


def list_persons(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Persons, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_persons",
        "GET",
        "/v1/persons",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def forget_person(name: str) -> Call[None]:
    """Remove a person from all labels, and delete every model that holds the person.

    The person's name also leaves the names, paths, sources, words and metadata of clips, and the
    lists of imported files: `anna_walk.bvh` becomes `anonymous_walk.bvh`. In clips of others, a
    name without a letter leaves only metadata that are nothing but the name. The contents of the
    stored files stay. The models are fitted again in the background. Until then recognition,
    synthesis and `metric-person` answer 409 `model_not_fitted` with `Retry-After`.
    """
    return Call("forget_person", "DELETE", path_of("/v1/persons/{name}", name=name), nothing)


def list_tasks(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Tasks, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_tasks",
        "GET",
        "/v1/tasks",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def list_words(
    *, q: str | None = None, limit: int | None = None, cursor: str | None = None
) -> Call[NamedCounts]:
    """Words by name, with numbers of clips; or completions of `q`, the likeliest first.

    q: Only words that begin with this or hold it, or else words of which it is a form.
    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_words",
        "GET",
        "/v1/words",
        record(NamedCounts),
        query=given(q=q, limit=limit, cursor=cursor),
    )


def list_sources(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Sources of clips, with the number of clips from each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_sources",
        "GET",
        "/v1/sources",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def list_licenses(*, limit: int | None = None, cursor: str | None = None) -> Call[NamedCounts]:
    """Licenses, with the number of clips of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import NamedCounts

    return Call(
        "list_licenses",
        "GET",
        "/v1/licenses",
        record(NamedCounts),
        query=given(limit=limit, cursor=cursor),
    )


def list_metadata(*, limit: int | None = None, cursor: str | None = None) -> Call[MetadataKeys]:
    """The keys of the metadata of clips, with the kinds and the most frequent values of each.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.labels import MetadataKeys

    return Call(
        "list_metadata",
        "GET",
        "/v1/metadata",
        record(MetadataKeys),
        query=given(limit=limit, cursor=cursor),
    )


def list_folders(
    *, limit: int | None = None, cursor: str | None = None, folder: str | None = None
) -> Call[FolderList]:
    """The folders directly in a folder, with the number of clips in and below each.

    A clip that was imported from a folder or a ZIP has the path that its file had there.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    folder: Default: the root.
    """
    from kinedex.types.labels import FolderList

    return Call(
        "list_folders",
        "GET",
        "/v1/folders",
        record(FolderList),
        query=given(limit=limit, cursor=cursor, folder=folder),
    )


def get_manifest(
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
    filter: Filter | Mapping[str, Any] | None = None,
) -> Call[bytes]:
    """The labels, hints and metadata of clips, as a manifest that an import reads again.

    task: Kinds of it too, as of a word (`/v1/labels/tree`); none with = before it.
    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    folder: Clips whose files were in this folder of an import, or below it.
    not_folder: Clips of none of these folders.
    collection: Ids of collections: clips in any of them.
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
    filter: Filters by name, as in a search, for those that are no arguments: {"meta.condition":
        "tired", "meta.age.min": 30}.
    """
    return Call(
        "get_manifest",
        "GET",
        "/v1/manifest.csv",
        read_bytes,
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
        )
        | given(**(filter or {})),
        accept="*/*",
    )


def get_annotation_table(
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
    filter: Filter | Mapping[str, Any] | None = None,
) -> Call[bytes]:
    """The annotations of clips by path, as an `annotations.csv` that an import reads again.

    task: Kinds of it too, as of a word (`/v1/labels/tree`); none with = before it.
    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    folder: Clips whose files were in this folder of an import, or below it.
    not_folder: Clips of none of these folders.
    collection: Ids of collections: clips in any of them.
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
    filter: Filters by name, as in a search, for those that are no arguments: {"meta.condition":
        "tired", "meta.age.min": 30}.
    """
    return Call(
        "get_annotation_table",
        "GET",
        "/v1/annotations.csv",
        read_bytes,
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
        )
        | given(**(filter or {})),
        accept="*/*",
    )
