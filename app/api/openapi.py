"""The parts of the OpenAPI description that FastAPI cannot derive from the routes.

These are the problems (RFC 9457), and the bodies that routes read without FastAPI.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

from fastapi import Path
from pydantic import BaseModel

from app import errors
from app.api.bodies import MAX_FIELD_BYTES
from app.api.failures import problems
from app.api.failures.problems import problem_of
from app.kinedex_error import KinedexError, Place

REF = "#/components/schemas/{model}"
_DESCRIPTIONS = {
    400: "The body does not match its Content-Type",
    401: "An API key is needed",
    403: "This API key does not allow that",
    404: "The clip, job or other object does not exist",
    408: "The body came too slowly",
    409: "The current state does not allow this; with `Retry-After` if waiting helps",
    413: "The body is larger than the limit",
    415: "The content or its media type is not supported",
    422: "A field is wrong, or the file cannot be used",
    429: "Too many calls, or too many wrong keys; with `Retry-After`",
    500: "Something went wrong; the log has the details",
    503: "The service is starting or too busy, or the call took longer than its time limit; with "
    "`Retry-After`",
    507: "The disk is full; nothing was stored",
}
_EXAMPLES: dict[int, KinedexError] = {
    400: problems.MalformedBody("The body is not valid JSON."),
    401: errors.Unauthorized("This key is not valid."),
    403: errors.Forbidden("This needs a key with the role write."),
    404: errors.ClipNotFound(
        "There is no clip with the id 'clip_1'", places=[Place("path.clip_id", "is no clip's id")]
    ),
    408: problems.RequestTimeout("The body came too slowly."),
    413: errors.TooLarge("The body is larger than the limit of 210763776 bytes."),
    415: problems.UnsupportedMediaType("This call takes application/json."),
    422: errors.BadField(
        "The request has fields that are wrong.",
        places=[Place("query.limit", "Input should be less than or equal to 1000")],
    ),
    429: problems.RateLimited(retry_after=1),
    500: KinedexError(),
    503: problems.TooBusy("Too many heavy calls are waiting; try again shortly."),
    507: errors.DiskFull(),
}
"""A failure of each status but 409, as the example of the problem."""
_CONFLICTS: dict[type[KinedexError], KinedexError] = {
    kind: kind(detail)
    for kind, detail in {
        errors.AlreadyVoted: None,
        errors.AnswerLost: None,
        errors.CallInProgress: None,
        errors.CallOvertaken: None,
        errors.ClipNotReady: "The clip clip_1 is queued; ask again after that.",
        errors.Conflict: None,
        errors.ModelNotFitted: None,
        errors.NoSignatures: None,
        errors.NotEnoughKeyposes: None,
        errors.NotEnoughLabels: None,
    }.items()
}
"""The failures with the status 409, as examples. A route names those that it can answer."""
OF_A_KEY = (errors.CallInProgress, errors.CallOvertaken, errors.AnswerLost)
"""Conflicts of every call that takes an Idempotency-Key."""
BINARY = {"schema": {"type": "string", "format": "binary"}}
"""Bytes as the content of an answer. Of an answer without a schema, generated clients lose them."""
_EVERYWHERE = (401, 403, 422, 429, 500, 503)
_WITH_A_BODY = (408, 413)
"""Statuses of every call that has a body. A route with a body lists 413."""
_REQUEST_ID = {
    "name": "X-Request-Id",
    "in": "header",
    "required": False,
    "schema": {"type": "string", "maxLength": 64},
    "description": "Your own id of this request. The answer and the log repeat it.",
}


def _id(what: str, placeholder: str) -> Any:
    """The path parameter of an id. `describe` replaces the placeholder by a real id."""
    return Path(max_length=MAX_ID_LENGTH, openapi_examples={what: {"value": placeholder}})


MAX_ID_LENGTH = 100
ClipId = Annotated[str, _id("a clip", "CLIP_ID")]
AudioClipId = Annotated[str, _id("a clip with a recording", "AUDIO_CLIP_ID")]
JobId = Annotated[str, _id("a job", "JOB_ID")]
PairId = Annotated[str, _id("a pair", "PAIR_ID")]
ModelId = Annotated[str, _id("a recognizer", "MODEL_ID")]
SignatureModelId = Annotated[str, _id("a multilinear model", "SIGNATURE_MODEL_ID")]
EvaluationId = Annotated[str, _id("an evaluation", "EVALUATION_ID")]
CollectionId = Annotated[str, _id("a collection", "COLLECTION_ID")]
ItemId = Annotated[str, _id("an item of it", "ITEM_ID")]
SearchId = Annotated[str, _id("a saved search", "SEARCH_ID")]
GroupId = Annotated[str, _id("a group of near-duplicates", "GROUP_ID")]
WebhookId = Annotated[str, _id("a webhook", "WEBHOOK_ID")]
AnnotationId = Annotated[str, _id("an annotation of the clip", "ANNOTATION_ID")]


def refusals(*answers: int | type[KinedexError]) -> dict[int | str, dict[str, Any]]:
    """Return the `responses=` of a route: these answers, and those that every call has.

    answers: statuses; and for 409, which says nothing without its code, the failures themselves.
    """
    statuses = {one for one in answers if isinstance(one, int)}
    conflicts = [one for one in answers if not isinstance(one, int)]
    with_a_body = _WITH_A_BODY if 413 in statuses else ()
    found: dict[int | str, dict[str, Any]] = {
        status: refusal(status, {"example": problem_of(_EXAMPLES[status])})
        for status in {*statuses, *_EVERYWHERE, *with_a_body}
    }
    if conflicts:
        found[409] = refusal(409, {"examples": examples_of(conflicts)})
    return dict(sorted(found.items()))


def refusal(status: int, examples: Mapping[str, Any]) -> dict[str, Any]:
    """The description of one status, whose answer is a problem."""
    schema = {"$ref": REF.format(model="Problem")}
    content = {problems.MEDIA_TYPE: {"schema": schema, **examples}}
    return {"description": _DESCRIPTIONS[status], "content": content}


def examples_of(conflicts: Iterable[type[KinedexError]]) -> dict[str, Any]:
    """Examples of problems with the status 409, by code."""
    return {kind.code: {"value": problem_of(_CONFLICTS[kind])} for kind in conflicts}


def body(
    *,
    model: type[BaseModel] | None = None,
    examples: Mapping[str, Any] | None = None,
    form: type[BaseModel] | None = None,
    files: Mapping[str, str] | None = None,
    needed: Sequence[str] = (),
) -> dict[str, Any]:
    """Return the `openapi_extra=` of a route that reads JSON as `model`, or a form.

    form: the text fields of the form; files: a description of each file, by field name; needed:
    the required fields of the form.

    Every call takes the header X-Request-Id, but only a call with two kinds of body describes it
    here. The reason is openapi-python-client 0.29: for a call with two kinds of body and no
    optional parameter, it generates a module that cannot be imported (`NameError: Unset`).
    """
    content: dict[str, Any] = {}
    if model is not None:
        content["application/json"] = {
            "schema": {"$ref": REF.format(model=model.__name__)},
            "examples": {name: {"value": value} for name, value in (examples or {}).items()},
        }
    if form is not None:
        content["multipart/form-data"] = {"schema": _form_schema(form, files or {}, needed)}
    described: dict[str, Any] = {"requestBody": {"required": True, "content": content}}
    if len(content) > 1:
        described["parameters"] = [_REQUEST_ID]
    return described


def _form_schema(
    form: type[BaseModel], files: Mapping[str, str], needed: Sequence[str]
) -> dict[str, Any]:
    schema = form.model_json_schema(ref_template=REF)
    schema.pop("$defs", None)  # the definitions are in the components of the description
    uploads = {
        name: {"type": "string", "format": "binary", "description": text}
        for name, text in files.items()
    }
    texts = {name: _text_field(field) for name, field in schema["properties"].items()}
    schema["properties"] = {**uploads, **texts}
    if needed:
        schema["required"] = list(needed)
    return schema


def without_null(field: dict[str, Any]) -> dict[str, Any]:
    """The schema of a field or parameter that is left out if it has no value."""
    if "anyOf" not in field:
        return field
    kinds = [kind for kind in field["anyOf"] if kind != {"type": "null"}]
    rest = {name: value for name, value in field.items() if name != "anyOf"}
    alone = {**kinds[0], **rest} if len(kinds) == 1 else {**rest, "anyOf": kinds}
    return {name: value for name, value in alone.items() if value is not None}


_CONTENT = {"contentMediaType", "contentSchema"}
_BOUNDS = {"maxLength", "enum", "const", "format"}


def _text_field(field: dict[str, Any]) -> dict[str, Any]:
    """The schema of a text field as people fill it in.

    Without null, because a form leaves out a field that has no value; without the media type of
    the text, because Swagger UI asks for a file then. The example of a field that is usually left
    out is an empty text, also if the field is a number: else Swagger UI invents a value and sends
    it.
    """
    field = without_null(field)
    kept = {name: value for name, value in field.items() if name not in _CONTENT}
    if kept.get("type") == "string" and not _BOUNDS & kept.keys():
        kept["maxLength"] = MAX_FIELD_BYTES
    return kept if {"examples", "default"} & kept.keys() else {**kept, "examples": [""]}
