"""A motion as an answer: JSON written piece by piece, or raw float32.

A long clip has tens of millions of numbers, which as Python objects would take gigabytes;
neither form ever holds more than a few frames of them.
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
"""Of one piece: some 20 ms of work, during which Python's other threads wait."""
DECIMALS = 6
"""Of a metre: a micrometre."""


def wants_octets(request: Request) -> bool:
    """Whether the client would rather have octets than JSON, which is what it gets unasked."""
    weights = dict(_weights(request.headers.get("accept", "")))
    octets = weights.get(OCTETS, 0.0)
    anything = weights.get("*/*", 0.0)
    json_weight = weights.get("application/json", weights.get("application/*", anything))
    return octets > 0 and octets >= json_weight


def as_octets(view: MotionView) -> Response:
    """Little-endian float32 in C order; X-Shape tells frames, joints and 3."""
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
    more: Mapping[str, Any] | None = None,
    curves: Mapping[str, FloatArray] | None = None,
    behind: Iterable[str] = (),
) -> Response:
    """The members of the schema `Motion`, and more: small ones, and arrays as long as it.

    behind: JSON of other members, in pieces, each member with a comma before it.
    """
    head = {
        "frame_rate": view.frame_rate,
        "joint_names": view.joint_names,
        "parents": view.parents,
        **(more or {}),
    }
    content = _json(head, {**(curves or {}), "positions": view.positions}, behind)
    return Pieces(content, media_type="application/json", headers={"Vary": "Accept"})


def _octets(content: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> Iterator[bytes]:
    frames = _frames_at_once(content)
    for start in range(0, len(content), frames):
        yield content[start : start + frames].tobytes()


def _json(
    head: Mapping[str, Any], arrays: Mapping[str, FloatArray], behind: Iterable[str]
) -> Iterator[str]:
    yield json.dumps(head, allow_nan=False)[:-1]
    for name, array in arrays.items():
        yield f', "{name}": ['
        frames = _frames_at_once(array)
        for start in range(0, len(array), frames):
            part = array[start : start + frames].astype(np.float64)
            rows = json.dumps(np.round(part, DECIMALS).tolist(), separators=(",", ":"))
            yield ("," if start else "") + rows[1:-1]
        yield "]"
    yield from behind
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
