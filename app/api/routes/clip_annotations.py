"""Annotations of a clip in time: words, persons and sentences for its parts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response
from starlette.datastructures import UploadFile

from app.api.bodies import read_form, require_json, require_json_if_any, required
from app.api.deps import Lib, reads, reads_source, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.guard.audited import exported
from app.api.openapi import BINARY, AnnotationId, ClipId, body, refusals
from app.api.path_parameters import register_other_than
from app.api.routes.export import attachment
from app.api.schemas.annotations import (
    AcceptedSuggestions,
    Annotation,
    AnnotationFileForm,
    AnnotationFileQuery,
    AnnotationPatch,
    Annotations,
    AnnotationsSent,
    AnnotationSuggestions,
    NewAnnotation,
)
from app.errors import ClipNotReady, ModelNotFitted
from app.services.annotations import clip_annotations as kept
from app.services.annotations import files, suggestions
from app.services.annotations.files import AnnotationFormat

router = APIRouter(prefix="/v1/clips/{clip_id}/annotations", tags=["clips"])
ANNOTATION = register_other_than("annotation", "file", "suggestions")
MEDIA_TYPES = {
    AnnotationFormat.CSV: "text/csv",
    AnnotationFormat.EAF: "application/xml",
    AnnotationFormat.BABEL: "application/json",
}
FILES = {"file": "The annotations: CSV, ELAN or JSON of BABEL."}


@router.get("", dependencies=[reads_source, quick], responses=refusals(404))
def list_annotations(lib: Lib, clip_id: ClipId) -> Annotations:
    """The annotations of a clip: what is said about its parts, by start."""
    found = kept.list_annotations(lib, clip_id)
    return Annotations.model_validate({"items": found})


@router.put(
    "",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def replace_annotations(lib: Lib, clip_id: ClipId, sent: AnnotationsSent) -> Annotations:
    """Replace all annotations of a clip.

    The next fit learns from them: each part with words is a sample of its own. The words and the
    task of a clip whose parts have words teach no model any more, since they are true of only some
    of its parts.
    """
    stored = kept.replace_annotations(lib, clip_id, sent.values())
    return Annotations.model_validate({"items": stored})


@router.post(
    "",
    status_code=201,
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def add_annotation(lib: Lib, clip_id: ClipId, sent: NewAnnotation) -> Annotation:
    """Add an annotation to a clip."""
    return Annotation.model_validate(kept.add_annotation(lib, clip_id, sent.model_dump()))


async def _form(request: Request) -> tuple[AnnotationFileForm, UploadFile]:
    form, uploads = await read_form(request, AnnotationFileForm, FILES)
    return form, required(uploads, "file")


@router.get(
    "/file",
    dependencies=[reads_source, exported, quick],
    response_class=Response,
    responses={
        200: {
            "description": "The file, as an attachment.",
            "content": {"application/octet-stream": BINARY},
        },
        **refusals(404),
    },
)
def get_annotation_file(
    lib: Lib, clip_id: ClipId, query: Annotated[AnnotationFileQuery, Query()]
) -> Response:
    """The annotations of a clip as CSV, for ELAN (`.eaf`), or as JSON of BABEL."""
    file = files.export_annotations(lib, clip_id, query.format)
    return Response(
        file.content,
        media_type=MEDIA_TYPES[query.format],
        headers={"Content-Disposition": attachment(file.name)},
    )


@router.put(
    "/file",
    dependencies=[writes, Depends(_form), changes],
    responses=refusals(400, 404, 413, 415, 507),
    openapi_extra=body(form=AnnotationFileForm, files=FILES, needed=["file"]),
)
def put_annotation_file(
    lib: Lib,
    clip_id: ClipId,
    sent: Annotated[tuple[AnnotationFileForm, UploadFile], Depends(_form)],
) -> Annotations:
    """Replace all annotations of a clip by those of a file: CSV, ELAN (`.eaf`) or BABEL (JSON).

    In an ELAN file, annotations of different tiers with the same times are one. The tiers `words`,
    `person`, `text` and `by` are what their names say; the values of any other tier are words.
    """
    form, upload = sent
    stored = files.import_annotations(lib, clip_id, upload.file, form.format)
    return Annotations.model_validate({"items": stored})


@router.get(
    "/suggestions",
    dependencies=[reads, heavy],
    responses=refusals(404, ClipNotReady, ModelNotFitted),
)
def suggest_annotations(lib: Lib, clip_id: ClipId) -> AnnotationSuggestions:
    """Parts of a clip without annotation, with the words and the person that the models see."""
    found = suggestions.suggest_annotations(lib, clip_id)
    return AnnotationSuggestions.model_validate({"items": found})


@router.post(
    "/suggestions/accept",
    dependencies=[writes, Depends(require_json_if_any), heavy],
    responses=refusals(400, 404, 413, 415, ClipNotReady, ModelNotFitted),
)
def accept_annotations(
    lib: Lib, clip_id: ClipId, accepted: AcceptedSuggestions | None = None
) -> Annotations:
    """Make annotations of suggestions: of those that the body names, or of all of them."""
    chosen = accepted or AcceptedSuggestions.model_validate({})
    parts = None if chosen.items is None else [(one.start, one.end) for one in chosen.items]
    stored = suggestions.accept_annotations(lib, clip_id, parts, chosen.by)
    return Annotations.model_validate({"items": stored})


@router.get(
    f"/{{annotation_id:{ANNOTATION}}}",
    dependencies=[reads_source, quick],
    responses=refusals(404),
)
def get_annotation(lib: Lib, clip_id: ClipId, annotation_id: AnnotationId) -> Annotation:
    """One annotation."""
    return Annotation.model_validate(kept.get_annotation(lib, clip_id, annotation_id))


@router.patch(
    f"/{{annotation_id:{ANNOTATION}}}",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def update_annotation(
    lib: Lib, clip_id: ClipId, annotation_id: AnnotationId, patch: AnnotationPatch
) -> Annotation:
    """Correct an annotation. It then counts as made by a person."""
    changed = patch.model_dump(exclude_unset=True)
    return Annotation.model_validate(kept.change_annotation(lib, clip_id, annotation_id, changed))


@router.delete(
    f"/{{annotation_id:{ANNOTATION}}}",
    status_code=204,
    dependencies=[writes, changes],
    responses=refusals(404),
)
def delete_annotation(lib: Lib, clip_id: ClipId, annotation_id: AnnotationId) -> None:
    """Delete an annotation."""
    kept.delete_annotation(lib, clip_id, annotation_id)
