"""Long motions made of real clips, with pieces of others hidden in them, as a library.

Each piece is hidden COPIES times: at another speed (up to 10 % longer or shorter, swaying by
10 %), heading, place, body size and frame rate, with marker noise.
"""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.frame_features import frame_features
from app.errors import BadContent
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from app.services.clips import catalogue as clips
from app.services.library.library import Library
from tests.bodies import motion_of, turned_about_y
from tests.libraries import work
from tests.real_clips import manifest, real_clips
from tests.streams import Stream, at_rate, body_of, joined, npz_of, of_size, warped

RATE = 30.0
LENGTHS = (0.6, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
"""Seconds, of pieces."""
PIECES, COPIES = 40, 5
STREAM_RATES = (30.0, 60.0, 24.0, 120.0, 50.0, 100.0)
NOISE = 0.003
"""Metres, of each marker in each frame."""
LEAST_MOVING = 0.03
"""Of a piece, rms of its velocities: stillness is everywhere."""

Span = tuple[str, float, float]
"""Clip id, start and end in seconds."""


@dataclass(frozen=True)
class Take:
    """A real clip: who does what, and how, (frames, 13, 3) at RATE."""

    person: str
    task: str
    source: str
    body: FloatArray


@dataclass
class Hidden:
    """A library of long motions; the pieces, where each is hidden, and where whole takes are."""

    lib: Library
    seconds: float
    pieces: list[FloatArray]
    places: list[list[Span]]
    takes: dict[tuple[str, str, str], list[Span]]
    streams: dict[str, FloatArray]


def real_takes() -> list[Take]:
    """The real clips that are files of their own."""
    found = []
    for row in manifest():
        content = (real_clips() / row["path"]).read_bytes()
        try:
            body = body_of(content, float(row["fps"]))
        except BadContent:
            continue  # AMC without its ASF
        found.append(Take(row["person"], row["task"], row["source"], body))
    return found


def hide(
    lib: Library, sources: list[Take], filling: list[Take], rng: np.random.Generator
) -> Hidden:
    """Cut pieces from `sources`, and hide them among those of `filling` that none was cut from."""
    pieces, used = _cut(sources, rng)
    parts: list[tuple[FloatArray, object]] = [
        (take.body, (take.task, take.person, take.source))
        for take in filling
        if not any(take is one for one in used)
    ]
    for number, piece in enumerate(pieces):
        for _ in range(COPIES):
            copy = warped(piece, rng.uniform(0.9, 1.1), rng.uniform(-0.1, 0.1))
            parts.append((turned_about_y(copy, rng.uniform(-3, 3)), number))
    order = rng.permutation(len(parts))
    found = Hidden(lib, 0.0, pieces, [[] for _ in pieces], {}, {})
    for number, rate in enumerate(STREAM_RATES):
        mine = [parts[i] for i in order[number :: len(STREAM_RATES)]]
        stream = joined([body for body, _ in mine], RATE)
        clip_id, seconds = _store(lib, stream, rate, f"stream {number}", rng)
        found.seconds += len(stream.body) / RATE
        found.streams[clip_id] = stream.body
        for (start, end), (_, what) in zip(stream.spans, mine, strict=True):
            span = clip_id, start, min(end, seconds)
            if isinstance(what, int):
                found.places[what].append(span)
            elif isinstance(what, tuple):
                found.takes.setdefault(what, []).append(span)
    work(lib.settings)
    return found


def _cut(sources: list[Take], rng: np.random.Generator) -> tuple[list[FloatArray], list[Take]]:
    """Moving pieces of all lengths, each from a take of its own."""
    pieces: list[FloatArray] = []
    used: list[Take] = []
    for index in rng.permutation(len(sources)):
        take = sources[index]
        frames = round(LENGTHS[len(pieces) % len(LENGTHS)] * RATE)
        if len(pieces) == PIECES or len(take.body) < frames + 2:
            continue
        first = int(rng.integers(0, len(take.body) - frames + 1))
        piece = take.body[first : first + frames]
        moving = frame_features(body_track(motion_of(piece)))[:, 39:78]
        if np.sqrt(np.mean(moving**2)) >= LEAST_MOVING:
            pieces.append(piece)
            used.append(take)
    return pieces, used


def _store(
    lib: Library, stream: Stream, rate: float, name: str, rng: np.random.Generator
) -> tuple[str, float]:
    """The id and the seconds of the clip that the stream becomes."""
    body = at_rate(of_size(stream.body, rng.uniform(0.9, 1.3)), RATE, rate)
    noisy = body + rng.normal(scale=NOISE, size=body.shape)
    content = io.BytesIO(npz_of(noisy, rate))
    clip = clips.create_clip(lib, content, f"{name}.npz").clip
    return clip.id, len(body) / rate
