"""The whole OpenAPI description: what FastAPI derives from the routes, and what it cannot know.

Added are the schemas of bodies that routes read themselves, the header Idempotency-Key, and the
members that `fields=` may name.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from app.api.failures import problems
from app.api.guard.idempotency import HEADER, takes_key
from app.api.openapi import OF_A_KEY, REF, examples_of, refusal, without_null
from app.api.schemas.problem import Problem

_IDEMPOTENCY_KEY = {
    "name": HEADER,
    "in": "header",
    "required": False,
    "schema": {"type": "string", "minLength": 1, "maxLength": 255, "pattern": "^[!-~]+$"},
    "description": "A random text that you choose for this call. If you send the call again with "
    "the same text within 24 hours, it takes no effect again and returns the first answer. With "
    "another body it is refused (422); while the first call runs, it answers 409.",
}


def describe(
    app: FastAPI, bodies: Sequence[type[BaseModel]], ids: Callable[[], Mapping[str, str]]
) -> None:
    """Add the schemas of `bodies` and of problems to `app.openapi()`. It is built once.

    ids: returns the values that replace CLIP_ID, PERSON and so on in the examples, by placeholder
    (`app.api.examples`). With real ids, the examples can be run.
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
        [(model, "validation") for model in extra_models], ref_template=REF
    )
    schemas = description.setdefault("components", {}).setdefault("schemas", {})
    schemas.update(extra.get("$defs", {}))
    _add_idempotency_keys(description["paths"])
    for operation in _operations(description["paths"]):
        for parameter in operation.get("parameters", ()):
            parameter["schema"] = without_null(parameter["schema"])
            if parameter["name"] == "fields":
                _name_members(parameter, operation, schemas)
    _describe_events_as_text(description["paths"])
    return description


def _operations(paths: dict[str, Any]) -> Iterable[dict[str, Any]]:
    return (operation for item in paths.values() for operation in item.values())


def _name_members(
    parameter: dict[str, Any], operation: dict[str, Any], schemas: Mapping[str, Any]
) -> None:
    """Describe the values of `fields=`: members of the answer's items, with commas between them."""
    answer = _schema_at(operation["responses"]["200"]["content"]["application/json"], schemas)
    members = answer["properties"]
    if "items" in members:
        members = _schema_at({"schema": members["items"]["items"]}, schemas)["properties"]
    names = list(members)
    if "clip" in members:
        clip = _schema_at({"schema": members["clip"]}, schemas)["properties"]
        names[names.index("clip")] = rf"clip(\.({'|'.join(clip)}))?"
    parameter["schema"]["items"]["pattern"] = f"^({'|'.join(names)})$"
    parameter["explode"] = False  # one parameter with commas; without it, one for each value


def _schema_at(content: Mapping[str, Any], schemas: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = schemas[content["schema"]["$ref"].rpartition("/")[2]]
    return found


def _describe_events_as_text(paths: dict[str, Any]) -> None:
    """FastAPI describes events by `itemSchema` of OpenAPI 3.2; openapi-generator refuses it."""
    for item in paths.values():
        for operation in item.values():
            for response in operation["responses"].values():
                events = response.get("content", {}).get("text/event-stream")
                if events is not None:
                    events.clear()
                    events["schema"] = {"type": "string"}


def _add_idempotency_keys(paths: dict[str, Any]) -> None:
    for path, item in paths.items():
        for method, operation in item.items():
            if takes_key(method, path):
                operation.setdefault("parameters", []).append(_IDEMPOTENCY_KEY)
                found = operation["responses"].setdefault("409", refusal(409, {"examples": {}}))
                found["content"][problems.MEDIA_TYPE]["examples"] |= examples_of(OF_A_KEY)
