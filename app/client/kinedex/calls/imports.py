"""Calls: imports. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given
from kinedex.types.jobs import JobStarted


def start_import(archive: FileInput, *, progress: Progress | None = None) -> Call[JobStarted]:
    """Store every motion file of a ZIP.

    `job.result` counts the outcomes. `GET /v1/jobs/{id}/files` lists the outcome of each file.

    archive: A ZIP of motion files; it may hold `manifest.csv`.
    progress: Called with the bytes that were sent and the bytes in total.
    """
    return Call(
        "start_import",
        "POST",
        "/v1/imports",
        record(JobStarted),
        fields=given(),
        files=given(archive=archive),
        progress=progress,
    )
