"""The parts of the OpenAPI description that FastAPI cannot derive from the routes.

These are the problems (RFC 9457), and the bodies that routes read without FastAPI.
"""

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
    400: "The body does not match its Content-Type",
    401: "An API key is needed",
    403: "This API key does not allow that",
    404: "The clip, job or other object does not exist",
    408: "The body came too slowly",
    409: "The current state does not allow this; with `Retry-After` if waiting helps",
    413: "The body is larger than the limit",
    415: "The content or its media type is not supported",
    422: "A field is wrong, or the file cannot be used",
    500: "Something went wrong; the log has the details",
    503: "The service is starting or too busy, or the call took longer than its time limit; with "
    "`Retry-After`",
    507: "The disk is full; nothing was stored",
}
_EVERYWHERE = (401, 403, 422, 500, 503)
_WITH_A_BODY = (408, 413)
"""Statuses of every call that has a body. A route with a body lists 413."""
_REQUEST_ID = {
    "name": "X-Request-Id",
    "in": "header",
    "required": False,
    "schema": {"type": "string", "maxLength": 64},
    "description": "Your own id of this request. The answer and the log repeat it.",
}


MAX_ID_LENGTH = 100
ClipId = Annotated[
    str, Path(max_length=MAX_ID_LENGTH, openapi_examples={"a clip": {"value": "CLIP_ID"}})
]
JobId = Annotated[
    str, Path(max_length=MAX_ID_LENGTH, openapi_examples={"a job": {"value": "JOB_ID"}})
]
PairId = Annotated[str, Path(max_length=MAX_ID_LENGTH)]


def refusals(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the `responses=` of a route: these statuses, and those that every call has."""
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
    schema.pop("$defs", None)  # the definitions are in the components of the description
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
    """Add the schemas of `bodies` and of problems to `app.openapi()`. It is built once.

    ids: returns the ids that replace CLIP_ID and JOB_ID in the examples, by placeholder. With
    real ids, the examples can be run.
    """

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _build(app, bodies)
        return _filled(app.openapi_schema, ids())

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way


def _filled(description: dict[str, Any], ids: Mapping[str, str]) -> dict[str, Any]:
    if not ids:
        return description
    text = json.dumps(description)
    for placeholder, identity in ids.items():
        text = text.replace(json.dumps(placeholder), json.dumps(identity))
    filled: dict[str, Any] = json.loads(text)
    return filled


def _build(app: FastAPI, bodies: Sequence[type[BaseModel]]) -> dict[str, Any]:
    description = get_openapi(
        title=app.title,
        version=app.version,
        summary=app.summary,
        description=app.description,
        routes=app.routes,
        tags=app.openapi_tags,
        license_info=app.license_info,
    )
    extra_models: list[type[BaseModel]] = [*bodies, Problem]
    _, extra = models_json_schema(
        [(model, "validation") for model in extra_models], ref_template=_REF
    )
    schemas = description.setdefault("components", {}).setdefault("schemas", {})
    schemas.update(extra.get("$defs", {}))
    return description
