"""Clips: store, list, read, correct, delete."""

from __future__ import annotations

import os
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask
from starlette.datastructures import UploadFile

from app.api.bodies import read_form, require_json, required
from app.api.deps import Lib, reads_source, writes
from app.api.guard.admission import changes, quick
from app.api.guard.audited import exported
from app.api.openapi import BINARY, ClipId, body, refusals
from app.api.queries import file_of
from app.api.schemas.clips import Clip, ClipCreated, ClipForm, ClipList, ClipPatch, ClipQuery
from app.api.schemas.measures import MeasuredClip
from app.api.sparse import ChosenFields, sparse_item, sparse_page
from app.api.validators import UNCHANGED, validate, weak_tag
from app.errors import ClipNotFound, Conflict
from app.services.clips import catalogue as clips
from app.services.clips.catalogue import StoredFile
from app.services.clips.merging import OnConflict
from app.services.clips.recordings import NewRecording
from app.services.curation import measures
from app.services.curation.measures import WithMeasures

router = APIRouter(prefix="/v1/clips", tags=["clips"])

FILES = {
    "file": "The motion: BVH, AMC, C3D, TRC, FBX, GLB, glTF, VRM, MVNX, NPZ, NPY, CSV of Motive or"
    " Nexus, TSV of Qualisys, or JSON of 3-D keypoints.",
    "skeleton": "The ASF file that an AMC file needs.",
    "audio": "The recording that goes with the motion: WAV, FLAC, OGG or MP3.",
}
ORIGINAL = {
    "content": {"application/octet-stream": BINARY},
    "description": "The original bytes.",
}


async def _form(request: Request) -> tuple[ClipForm, dict[str, UploadFile]]:
    return await read_form(request, ClipForm, FILES)


@router.post(
    "",
    status_code=202,
    dependencies=[writes, Depends(_form), changes],  # takes a slot after the form has arrived
    responses={
        200: {"model": ClipCreated, "description": "The same bytes were stored before."},
        **refusals(400, 413, 415, 503, 507, Conflict),
    },
    openapi_extra=body(form=ClipForm, files=FILES, needed=["file"]),
)
def create_clip(
    lib: Lib,
    sent: Annotated[tuple[ClipForm, dict[str, UploadFile]], Depends(_form)],
    response: Response,
) -> ClipCreated:
    """Store a clip. A worker analyzes it: then it is `ready`, or `failed` with an `error`.

    If the library has the same bytes already, the answer is their clip. `differences` lists the
    labels and hints that came with other values, and `on_conflict` says what happens to them.
    """
    form, uploads = sent
    upload = required(uploads, "file")
    created = clips.create_clip(
        lib,
        upload.file,
        upload.filename or "clip",
        form.labels(),
        skeleton=file_of(uploads, "skeleton"),
        recording=_recording(uploads),
        path=form.path,
        on_conflict=OnConflict(form.on_conflict),
    )
    if created.job is None:
        response.status_code = 200
    return ClipCreated.model_validate(created)


def _recording(uploads: dict[str, UploadFile]) -> NewRecording | None:
    sent = uploads.get("audio")
    return None if sent is None else NewRecording(sent.file, sent.filename or "audio")


@router.get(
    "", dependencies=[reads_source, quick], response_model=ClipList, responses=refusals(404)
)
def list_clips(lib: Lib, query: Annotated[ClipQuery, Query()]) -> ClipList | Response:
    """List the clips that pass every filter. Repeat a label parameter to accept several values.

    `meta.KEY=VALUE` filters by metadata, `not_meta.KEY=VALUE` refuses a value, `meta.KEY.min=30`
    and `meta.KEY.max=40` filter by a number (keys: `GET /v1/metadata`).
    `measure.NAME.min` and `measure.NAME.max` are bounds of a measure of `GET /v1/measures`.
    """
    page = clips.list_clips(lib, query.as_filter(), query.sort, query.limit, query.cursor)
    chosen = query.fields
    return sparse_page(ClipList, chosen, page) if chosen else ClipList.model_validate(page)


@router.get(
    "/{clip_id}",
    dependencies=[reads_source, quick],
    response_model=MeasuredClip,
    responses={304: UNCHANGED, **refusals(404)},
)
def get_clip(
    lib: Lib, request: Request, clip_id: ClipId, fields: ChosenFields = None
) -> MeasuredClip | Response:
    """One clip, with its measures beside those of the library."""
    clip = clips.get_clip(lib, clip_id)
    measured = WithMeasures(clip, measures.of_clip(lib, clip))
    validate(request, weak_tag(clip, measured.measures, fields))
    if fields:
        return sparse_item(MeasuredClip, fields, measured)
    return MeasuredClip.model_validate(measured)


@router.patch(
    "/{clip_id}",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def update_clip(lib: Lib, clip_id: ClipId, patch: ClipPatch) -> Clip:
    """Correct the labels or hints of a clip."""
    changed = clips.update_clip(lib, clip_id, patch.model_dump(exclude_unset=True))
    return Clip.model_validate(changed)


@router.delete(
    "/{clip_id}", status_code=204, dependencies=[writes, changes], responses=refusals(404)
)
def delete_clip(lib: Lib, clip_id: ClipId) -> None:
    """Delete a clip, its file and everything that was computed from it."""
    clips.delete_clip(lib, clip_id)


@router.get(
    "/{clip_id}/file",
    dependencies=[reads_source, exported, quick],
    response_class=FileResponse,
    responses={
        200: ORIGINAL,
        304: UNCHANGED,
        **refusals(404),
    },
)
def get_file(lib: Lib, request: Request, clip_id: ClipId) -> FileResponse:
    """The original file, as an attachment: a browser must not show foreign content as a page."""
    return attachment(request, clips.open_file(lib, clip_id), clip_id)


def attachment(request: Request, file: StoredFile, clip_id: str) -> FileResponse:
    """A stored file of a clip as an attachment, with an ETag. Raises ClipNotFound."""
    tag = f'"{file.sha256}"'
    validate(request, tag)
    try:
        content = file.path.open("rb")
    except FileNotFoundError as error:
        raise ClipNotFound(f"The clip {clip_id} was deleted.") from error
    # We send the open descriptor: the file stays complete even if the clip is deleted meanwhile.
    return FileResponse(
        f"/dev/fd/{content.fileno()}",
        stat_result=os.fstat(content.fileno()),
        media_type="application/octet-stream",
        filename=file.name,
        content_disposition_type="attachment",
        headers={"ETag": tag},
        background=BackgroundTask(content.close),
    )
