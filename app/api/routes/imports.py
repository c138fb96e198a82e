"""Imports: many clips in one archive."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Request
from starlette.datastructures import UploadFile

from app.api.bodies import read_form, required
from app.api.deps import Lib, writes
from app.api.guard.admission import changes
from app.api.openapi import body, refusals
from app.api.schemas.imports import ImportForm
from app.api.schemas.jobs import Job, JobStarted
from app.services.imports import imports

router = APIRouter(prefix="/v1/imports", tags=["clips"])

FILES = {"archive": "A ZIP of motion files; it may hold `manifest.csv`."}
DESCRIPTION = """\
Store every motion file of a ZIP, and the recordings that belong to them.

Labels come from a row of `manifest.csv`, else from the pattern `labels`, else from the fields of
the form. A manifest may be in any folder; its paths are relative to that folder. Its columns:

- `path` is the only column that is needed. `name`, `person`, `task`, `license` and `source` are
  labels. `words` are separated by spaces, and a phrase has underscores (`left_leg`). `captions`
  are sentences, separated by `|`.
- `fps` (or `frame_rate`), `unit` and `up_axis` say what a file does not say, or says wrongly.
- `audio` is the path of a recording (WAV, FLAC, OGG or MP3), and `audio_offset` the time in the
  motion at which it begins, in seconds. `tempo` and `beats` replace the beats of the recording.
  `keyposes` are the times of keyposes in seconds; Kinedex learns its thresholds from them.
- Any other column becomes metadata: strings, numbers, `true` or `false`. A column that is almost a
  field (`tsak`) is an error that names the field; `meta.tsak` is metadata in any case.

Annotations of parts of a clip come as `kick.eaf` (ELAN) or `kick.babel.json` beside `kick.bvh`, or
as rows of `annotations.csv` in any folder: `clip` (a path relative to that folder), `start`, `end`,
`words`, `person`, `text`, `by`.

Correct the manifest and import again: new values replace the old ones. If somebody edited a value
since, it stays, and the file is `conflicting` with both values; `overwrite` replaces it. Files that
are no motions, like `notes.txt`, are skipped.

`job.result` counts the files by outcome and lists the first 100, failed files first.
`GET /v1/jobs/{id}/files?outcome=failed` lists all of them. Imports take turns: a small import does
not wait for a large one. Meanwhile the job of the large one is `queued` again.

The manifests of one import have at most as many rows as an archive may have files
(`KINEDEX_MAX_ARCHIVE_ENTRIES`), 64 MiB, 100 columns, and 131,072 characters in a field. Over a
limit the import fails at once and names the line.
"""


async def _form(request: Request) -> tuple[ImportForm, UploadFile]:
    form, uploads = await read_form(request, ImportForm, FILES)
    return form, required(uploads, "archive")


@router.post(
    "",
    status_code=202,
    dependencies=[writes, Depends(_form), changes],
    responses=refusals(400, 413, 415, 503, 507),
    description=DESCRIPTION,
    openapi_extra=body(form=ImportForm, files=FILES, needed=["archive"]),
)
def start_import(
    lib: Lib, sent: Annotated[tuple[ImportForm, UploadFile], Depends(_form)]
) -> JobStarted:
    """Store every motion file of a ZIP."""
    form, archive = sent
    filename = archive.filename or "archive.zip"
    job = imports.start_import(lib, archive.file, filename, form.options())
    return JobStarted(job=Job.model_validate(job))


@router.post("/demo", status_code=202, dependencies=[writes, changes], responses=refusals())
def start_demo_import(lib: Lib) -> JobStarted:
    """Add the demo library: 150 motions of six invented persons, to try everything with.

    A worker generates them on this machine. Clips that the library has already are not added again.
    """
    return JobStarted(job=Job.model_validate(imports.start_demo(lib)))
