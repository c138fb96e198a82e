"""Calls: imports. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given
from kinedex.types.jobs import JobStarted


def start_import(
    archive: FileInput,
    *,
    person: str | None = None,
    task: str | None = None,
    words: str | None = None,
    license: str | None = None,
    source: str | None = None,
    metadata: str | None = None,
    labels: str | None = None,
    overwrite: bool | None = None,
    progress: Progress | None = None,
) -> Call[JobStarted]:
    """Store every motion file of a ZIP.

    A file that the library has already gets the labels that come now, except those that somebody
    edited since. `job.result` counts the outcomes. `GET /v1/jobs/{id}/files` lists the outcome
    of each file.

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
    return Call("start_demo_import", "POST", "/v1/imports/demo", record(JobStarted))
