"""A motion as an answer: JSON in pieces, or raw float32.

A long clip has tens of millions of numbers. As Python objects they would take gigabytes, so both
forms convert only a few frames at a time.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from fastapi import Request
from fastapi.responses import Response

from app.api.pieces import Pieces
from app.numerics.arrays import FloatArray
from app.services.views.views import MotionView

OCTETS = "application/octet-stream"
NUMBERS_AT_ONCE = 50_000
"""Numbers in one piece: about 20 ms of work, during which Python's other threads wait."""
DECIMALS = 6
"""Decimals of a coordinate in meters: micrometers."""


def prefers_octets(request: Request) -> bool:
    """Whether the client's Accept header prefers octets to JSON. JSON is the default."""
    weights = dict(_weights(request.headers.get("accept", "")))
    octets = weights.get(OCTETS, 0.0)
    anything = weights.get("*/*", 0.0)
    json_weight = weights.get("application/json", weights.get("application/*", anything))
    return octets > 0 and octets >= json_weight


def as_octets(view: MotionView) -> Response:
    """Return the positions as little-endian float32 in C order, in meters, Y up.

    The header X-Shape holds the shape: frames, joints, 3.
    """
    content = np.ascontiguousarray(view.positions, dtype="<f4")
    headers = {
        "X-Shape": ",".join(str(size) for size in content.shape),
        "X-Frame-Rate": f"{view.frame_rate:.9g}",
        "Content-Length": str(content.nbytes),
        "Vary": "Accept",
    }
    return Pieces(_octets(content), media_type=OCTETS, headers=headers)


def as_json(
    view: MotionView,
    members: Mapping[str, Any] | None = None,
    curves: Mapping[str, FloatArray] | None = None,
    trailing: Iterable[str] = (),
) -> Response:
    """Return the members of the schema `Motion` as JSON, and further members.

    members: further small members, by name; curves: further arrays with one row for each frame,
    by name; trailing: JSON of further members, in pieces, with a comma before each member.
    """
    head = {
        "frame_rate": view.frame_rate,
        "joint_names": view.joint_names,
        "parents": view.parents,
        **(members or {}),
    }
    content = _json(head, {**(curves or {}), "positions": view.positions}, trailing)
    return Pieces(content, media_type="application/json", headers={"Vary": "Accept"})


def _octets(content: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> Iterator[bytes]:
    frames = _frames_at_once(content)
    for start in range(0, len(content), frames):
        yield content[start : start + frames].tobytes()


def _json(
    head: Mapping[str, Any], arrays: Mapping[str, FloatArray], trailing: Iterable[str]
) -> Iterator[str]:
    yield json.dumps(head, allow_nan=False)[:-1]  # without the closing brace
    for name, array in arrays.items():
        yield f', "{name}": ['
        frames = _frames_at_once(array)
        for start in range(0, len(array), frames):
            # (frames of this piece, ...): float64, because a rounded float32 has up to 17 digits.
            part = array[start : start + frames].astype(np.float64)
            rows = json.dumps(np.round(part, DECIMALS).tolist(), separators=(",", ":"))
            yield ("," if start else "") + rows[1:-1]
        yield "]"
    yield from trailing
    yield "}"


def _frames_at_once(array: FloatArray) -> int:
    return max(1, NUMBERS_AT_ONCE // max(1, math.prod(array.shape[1:])))


def _weights(accept: str) -> Iterator[tuple[str, float]]:
    for part in accept.split(","):
        kind, *parameters = (piece.strip().lower() for piece in part.split(";"))
        weight = next((p[2:] for p in parameters if p.startswith("q=")), "1")
        try:
            yield kind, float(weight)
        except ValueError:
            yield kind, 0.0
