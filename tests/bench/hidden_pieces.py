"""A library of long motions: real clips joined together, with pieces of other clips hidden in them.

Each piece is hidden COPIES times. Each copy has another speed (up to 10 % longer or shorter, and
varying by 10 %), heading, position, body size and frame rate, and has marker noise.
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
"""Durations of the pieces, seconds."""
PIECES, COPIES = 40, 5
STREAM_RATES = (30.0, 60.0, 24.0, 120.0, 50.0, 100.0)
NOISE = 0.003
"""Standard deviation of the noise on each marker in each frame, meters."""
MIN_RMS_VELOCITY = 0.03
"""Least RMS of the velocities of a piece: a still piece would match everywhere."""

Span = tuple[str, float, float]
"""Clip id, start and end in seconds."""


@dataclass(frozen=True)
class Take:
    """A real clip: its labels and its joint positions, (frames, 13, 3) at RATE."""

    person: str
    task: str
    source: str
    body: FloatArray


@dataclass
class Hidden:
    """A library of long motions.

    seconds: of all motions; pieces: (frames, 13, 3) each; spans: of the copies of each piece;
    takes: spans of whole takes, by task, person and source; streams: (frames, 13, 3) at RATE, by
    clip id.
    """

    lib: Library
    seconds: float
    pieces: list[FloatArray]
    spans: list[list[Span]]
    takes: dict[tuple[str, str, str], list[Span]]
    streams: dict[str, FloatArray]


def real_takes() -> list[Take]:
    """The real clips that one file describes completely."""
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
    """Cut pieces from `sources`, and hide them among the other takes of `filling`."""
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
                found.spans[what].append(span)
            elif isinstance(what, tuple):
                found.takes.setdefault(what, []).append(span)
    work(lib.settings)
    return found


def _cut(sources: list[Take], rng: np.random.Generator) -> tuple[list[FloatArray], list[Take]]:
    """Cut moving pieces of all lengths, each from another take."""
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
        if np.sqrt(np.mean(moving**2)) >= MIN_RMS_VELOCITY:
            pieces.append(piece)
            used.append(take)
    return pieces, used


def _store(
    lib: Library, stream: Stream, rate: float, name: str, rng: np.random.Generator
) -> tuple[str, float]:
    """Store the stream as a clip. Returns the clip's id and its duration in seconds."""
    body = at_rate(of_size(stream.body, rng.uniform(0.9, 1.3)), RATE, rate)
    noisy = body + rng.normal(scale=NOISE, size=body.shape)
    content = io.BytesIO(npz_of(noisy, rate))
    clip = clips.create_clip(lib, content, f"{name}.npz").clip
    return clip.id, len(body) / rate
