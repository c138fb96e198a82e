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


async def _form(request: Request) -> tuple[ImportForm, UploadFile]:
    form, uploads = await read_form(request, ImportForm, FILES)
    return form, required(uploads, "archive")


@router.post(
    "",
    status_code=202,
    dependencies=[writes, Depends(_form), changes],
    responses=refusals(400, 413, 415, 503, 507),
    openapi_extra=body(form=ImportForm, files=FILES, needed=["archive"]),
)
def start_import(
    lib: Lib, sent: Annotated[tuple[ImportForm, UploadFile], Depends(_form)]
) -> JobStarted:
    """Store every motion file of a ZIP.

    A file that the library has already gets the labels that come now, except those that somebody
    edited since. `job.result` counts the outcomes. `GET /v1/jobs/{id}/files` lists the outcome of
    each file.
    """
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
