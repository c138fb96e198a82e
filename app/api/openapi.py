"""The OpenAPI description: problems, and bodies that routes read by themselves."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any

from fastapi import FastAPI, Path
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from app.api.failures import problems
from app.api.schemas.problem import Problem

_REF = "#/components/schemas/{model}"
_DESCRIPTIONS = {
    400: "The body cannot be read as what its Content-Type says",
    401: "An API key is needed",
    403: "This API key does not allow that",
    404: "There is no such thing",
    408: "The body came too slowly",
    409: "The state of things does not allow this; with `Retry-After` where waiting helps",
    413: "The body is larger than the limit",
    415: "Content or media type that is not known here",
    422: "A field is wrong, or a file that cannot be used",
    500: "Something went wrong; the log tells what",
    503: "The service is starting or too busy, or the call took longer than its time limit; with "
    "`Retry-After`",
    507: "There is no space left; nothing was kept",
}
_EVERYWHERE = (401, 403, 422, 500, 503)
_WITH_A_BODY = (408, 413)
"""Of every call that has a body; such a call names 413."""
_REQUEST_ID = {
    "name": "X-Request-Id",
    "in": "header",
    "required": False,
    "schema": {"type": "string", "maxLength": 64},
    "description": "Your own id of this request: the answer and the log repeat it.",
}


LONGEST_ID = 100
ClipId = Annotated[
    str, Path(max_length=LONGEST_ID, openapi_examples={"a clip": {"value": "CLIP_ID"}})
]
JobId = Annotated[str, Path(max_length=LONGEST_ID, openapi_examples={"a job": {"value": "JOB_ID"}})]
PairId = Annotated[str, Path(max_length=LONGEST_ID)]


def refusals(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The `responses=` of a route: problems of these statuses and of those that any call has."""
    schema = {"$ref": _REF.format(model="Problem")}
    with_a_body = _WITH_A_BODY if 413 in statuses else ()
    return {
        status: {
            "description": _DESCRIPTIONS[status],
            "content": {problems.MEDIA_TYPE: {"schema": schema}},
        }
        for status in sorted({*statuses, *_EVERYWHERE, *with_a_body})
    }


def body(
    *,
    model: type[BaseModel] | None = None,
    examples: Mapping[str, Any] | None = None,
    form: type[BaseModel] | None = None,
    files: Mapping[str, str] | None = None,
    needed: Sequence[str] = (),
) -> dict[str, Any]:
    """The `openapi_extra=` of a route that reads JSON as `model` or a form as `form` and `files`.

    files: what each file is, by field name; needed: the fields of the form that must come.
    A call that takes both also describes its header X-Request-Id, which every call takes: of a
    call with two bodies and no optional parameter, openapi-python-client 0.29 writes a module
    that it cannot import (`NameError: Unset`).
    """
    content: dict[str, Any] = {}
    if model is not None:
        content["application/json"] = {
            "schema": {"$ref": _REF.format(model=model.__name__)},
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
    schema = form.model_json_schema(ref_template=_REF)
    schema.pop("$defs", None)
    uploads = {
        name: {"type": "string", "format": "binary", "description": text}
        for name, text in files.items()
    }
    schema["properties"] = {**uploads, **schema["properties"]}
    if needed:
        schema["required"] = list(needed)
    return schema


def describe(
    app: FastAPI, bodies: Sequence[type[BaseModel]], ids: Callable[[], Mapping[str, str]]
) -> None:
    """Make `app.openapi()` tell also the schemas of `bodies` and of problems; made once.

    ids: what CLIP_ID and JOB_ID in the examples are replaced by, so that they can be run.
    """

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _build(app, bodies)
        return _filled(app.openapi_schema, ids())

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way


def _filled(told: dict[str, Any], ids: Mapping[str, str]) -> dict[str, Any]:
    if not ids:
        return told
    text = json.dumps(told)
    for placeholder, identity in ids.items():
        text = text.replace(json.dumps(placeholder), json.dumps(identity))
    filled: dict[str, Any] = json.loads(text)
    return filled


def _build(app: FastAPI, bodies: Sequence[type[BaseModel]]) -> dict[str, Any]:
    told = get_openapi(
        title=app.title,
        version=app.version,
        summary=app.summary,
        description=app.description,
        routes=app.routes,
        tags=app.openapi_tags,
        license_info=app.license_info,
    )
    told_too: list[type[BaseModel]] = [*bodies, Problem]
    _, extra = models_json_schema([(model, "validation") for model in told_too], ref_template=_REF)
    schemas = told.setdefault("components", {}).setdefault("schemas", {})
    schemas.update(extra.get("$defs", {}))
    return told
