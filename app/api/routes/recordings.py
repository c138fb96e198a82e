"""The recordings that go with clips."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse

from app.api.deps import Lib, reads_source, writes
from app.api.guard.admission import changes, quick
from app.api.guard.audited import exported
from app.api.openapi import AudioClipId, refusals
from app.api.routes.clips import ORIGINAL, attachment
from app.api.schemas.clips import Clip
from app.api.validators import UNCHANGED
from app.services.clips import catalogue as clips

router = APIRouter(prefix="/v1/clips", tags=["clips"])


@router.get(
    "/{clip_id}/audio",
    dependencies=[reads_source, exported, quick],
    response_class=FileResponse,
    responses={
        200: ORIGINAL,
        304: UNCHANGED,
        **refusals(404),
    },
)
def get_audio(lib: Lib, request: Request, clip_id: AudioClipId) -> FileResponse:
    """The recording that goes with a clip, as an attachment."""
    return attachment(request, clips.open_recording(lib, clip_id), clip_id)


@router.delete("/{clip_id}/audio", dependencies=[writes, changes], responses=refusals(404))
def delete_audio(lib: Lib, clip_id: AudioClipId) -> Clip:
    """Delete the recording that goes with a clip. The clip is analyzed again."""
    return Clip.model_validate(clips.remove_recording(lib, clip_id))
