"""Calls: imports. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given

if TYPE_CHECKING:
    from kinedex.types.jobs import JobStarted


def start_import(
    archive: FileInput,
    *,
    person: str | None = None,
    task: str | None = None,
    words: str | None = None,
    license: str | None = None,
    source: str | None = None,
    metadata: str | Mapping[str, Any] | None = None,
    labels: str | None = None,
    overwrite: bool | None = None,
    progress: Progress | None = None,
) -> Call[JobStarted]:
    """Store every motion file of a ZIP, and the recordings that belong to them.

    Labels come from a row of `manifest.csv`, else from the pattern `labels`, else from the
    fields of the form. A manifest may be in any folder; its paths are relative to that folder.
    Its columns:

    - `path` is the only column that is needed. `name`, `person`, `task`, `license` and `source`
    are labels. `words` are separated by spaces, and a phrase has underscores (`left_leg`).
    `captions` are sentences, separated by `|`.
    - `fps` (or `frame_rate`), `unit` and `up_axis` say what a file does not say, or says
    wrongly.
    - `audio` is the path of a recording (WAV, FLAC, OGG or MP3), and `audio_offset` the time in
    the motion at which it begins, in seconds. `tempo` and `beats` replace the beats of the
    recording. `keyposes` are the times of keyposes in seconds; Kinedex learns its thresholds
    from them.
    - Any other column becomes metadata: strings, numbers, `true` or `false`. A column that is
    almost a field (`tsak`) is an error that names the field; `meta.tsak` is metadata in any
    case.

    Annotations of parts of a clip come as `kick.eaf` (ELAN) or `kick.babel.json` beside
    `kick.bvh`, or as rows of `annotations.csv` in any folder: `clip` (a path relative to that
    folder), `start`, `end`, `words`, `person`, `text`, `by`.

    Correct the manifest and import again: new values replace the old ones. If somebody edited a
    value since, it stays, and the file is `conflicting` with both values; `overwrite` replaces
    it. Files that are no motions, like `notes.txt`, are skipped.

    `job.result` counts the files by outcome and lists the first 100, failed files first. `GET
    /v1/jobs/{id}/files?outcome=failed` lists all of them. Imports take turns: a small import
    does not wait for a large one. Meanwhile the job of the large one is `queued` again.

    The manifests of one import have at most as many rows as an archive may have files
    (`KINEDEX_MAX_ARCHIVE_ENTRIES`), 64 MiB, 100 columns, and 131,072 characters in a field. Over
    a limit the import fails at once and names the line.

    archive: A ZIP of motion files; it may hold `manifest.csv`.
    person: For all files whose rows in a manifest and whose paths give none.
    task: For all files whose rows in a manifest and whose paths give none.
    words: For all files whose rows in a manifest and whose paths give none. Separated by spaces.
    license: For all files whose rows in a manifest and whose paths give none.
    source: For all files whose rows in a manifest and whose paths give none.
    metadata: JSON: values of your own by key. For all files whose rows in a manifest and whose
        paths give none.
    labels: Labels from the paths of files: a pattern like `{person}/{task}/{take}.bvh`. A name
        in braces that is no label becomes metadata; `*` is any name, `**` any folders.
    overwrite: Whether a label that comes now replaces one that somebody edited since an earlier
        import. By default it does not, and the file is `conflicting`. Default: False.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    from kinedex.types.jobs import JobStarted

    return Call(
        "start_import",
        "POST",
        "/v1/imports",
        record(JobStarted),
        fields=given(
            person=person,
            task=task,
            words=words,
            license=license,
            source=source,
            metadata=metadata,
            labels=labels,
            overwrite=overwrite,
        ),
        files=given(archive=archive),
        progress=progress,
    )


def start_demo_import() -> Call[JobStarted]:
    """Add the demo library: 150 motions of six invented persons, to try everything with.

    A worker generates them on this machine. Clips that the library has already are not added
    again.
    """
    from kinedex.types.jobs import JobStarted

    return Call("start_demo_import", "POST", "/v1/imports/demo", record(JobStarted))
