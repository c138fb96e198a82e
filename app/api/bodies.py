"""Bodies that FastAPI does not read by itself: multipart with limits, and JSON or multipart.

A pydantic model checks the text fields of a form; files are matched by the name of their field.
Browsers send an empty text field too: it counts as not sent.
"""

from __future__ import annotations

import errno
import json
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError
from starlette.datastructures import FormData, UploadFile
from starlette.exceptions import HTTPException

from app.api.failures.problems import MalformedBody, UnsupportedMediaType
from app.api.guard.media import FORM, is_json, media_type
from app.errors import BadField, DiskFull
from app.kinedex_error import Place

MAX_FIELDS = 32
MAX_FILES = 4
MAX_FIELD_BYTES = 64 * 2**10
"""A role mapping of a hundred joints needs about four thousand bytes."""

Model = TypeVar("Model", bound=BaseModel)


def require_json(request: Request) -> None:
    """Check that the Content-Type of the body is JSON. Raises UnsupportedMediaType."""
    if not is_json(media_type(request.headers)):
        raise UnsupportedMediaType("This call takes application/json.")


def require_json_if_any(request: Request) -> None:
    """Like require_json, but for a call that may also come without a body."""
    if media_type(request.headers) or request.headers.get("content-length", "0") != "0":
        require_json(request)


def is_multipart(request: Request) -> bool:
    """True if the body is a form with files, False if it is JSON.

    Raises UnsupportedMediaType if it is neither.
    """
    kind = media_type(request.headers)
    if kind != FORM and not is_json(kind):
        raise UnsupportedMediaType("This call takes application/json or multipart/form-data.")
    return kind == FORM


async def read_json(request: Request, model: type[Model]) -> Model:
    """Read the body as `model`. Raises MalformedBody and RequestValidationError."""
    try:
        content = json.loads(await request.body())
    except (ValueError, RecursionError) as error:
        raise MalformedBody("The body is not valid JSON.") from error
    return check(model, content)


async def read_form(
    request: Request, model: type[Model], files: Iterable[str]
) -> tuple[Model, dict[str, UploadFile]]:
    """Read a multipart body: its text fields as `model`, and the files that were sent.

    files: the names of the form fields that take a file.
    The files stay open until the request has been answered.
    Raises UnsupportedMediaType, MalformedBody, BadField, RequestValidationError, DiskFull.
    """
    if media_type(request.headers) != FORM:
        raise UnsupportedMediaType("This call takes multipart/form-data.")
    form = await _parse(request)
    # FastAPI closes this stack after the answer. That deletes the temporary files.
    request.scope["fastapi_middleware_astack"].push_async_callback(form.close)
    texts, uploads = _sort(form, set(files))
    return check(model, texts), uploads


async def _parse(request: Request) -> FormData:
    try:
        return await request.form(
            max_files=MAX_FILES, max_fields=MAX_FIELDS, max_part_size=MAX_FIELD_BYTES
        )
    except HTTPException as error:
        # Only 400 comes from the form parser. 408, 413 and 503 come from our own middlewares.
        if error.status_code != 400:
            raise
        raise MalformedBody(f"The form cannot be read: {error.detail}") from error
    except OSError as error:
        if error.errno in {errno.ENOSPC, errno.EDQUOT}:
            raise DiskFull from error
        raise
    except (ValueError, KeyError, AssertionError) as error:
        # The parser raises these for some malformed forms, instead of an HTTPException.
        raise MalformedBody("The form cannot be read.") from error


def _sort(form: FormData, files: set[str]) -> tuple[dict[str, str], dict[str, UploadFile]]:
    texts: dict[str, str] = {}
    uploads: dict[str, UploadFile] = {}
    wrong: list[Place] = []
    for name, value in form.multi_items():
        if name in texts or name in uploads:
            wrong.append(Place(f"body.{name}", "This field was sent more than once."))
        elif isinstance(value, UploadFile) and not (value.filename or value.size):
            continue  # A browser sends this if the user chose no file.
        elif isinstance(value, UploadFile) and name in files:
            uploads[name] = value
        elif isinstance(value, UploadFile):
            wrong.append(Place(f"body.{name}", "This field does not take a file."))
        elif name in files and value:
            wrong.append(Place(f"body.{name}", "This field takes a file, with a file name."))
        elif value:
            texts[name] = value
    if wrong:
        raise BadField("Some fields of the form are wrong.", places=wrong)
    return texts, uploads


def check(model: type[Model], content: Any) -> Model:
    """Validate `content` as `model`. Raises RequestValidationError with locations in `body`."""
    try:
        return model.model_validate(content)
    except ValidationError as error:
        details = error.errors(include_url=False, include_context=False, include_input=False)
        raise RequestValidationError(
            [{**detail, "loc": ("body", *detail["loc"])} for detail in details]
        ) from error


def required(uploads: Mapping[str, UploadFile], name: str) -> UploadFile:
    """Return the file with that name. Raises BadField if it was not sent."""
    if name not in uploads:
        raise BadField("A file is missing.", places=[Place(f"body.{name}", "Field required")])
    return uploads[name]
