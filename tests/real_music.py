"""The pieces of music with true beats, for the benches. No piece is copied."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import pytest

from app.formats.audio.reader import Sound, read_audio
from app.numerics.arrays import FloatArray
from tests.real_clips import real_clips


@dataclass(frozen=True)
class RealPiece:
    """A recording and its true beats (b,), in seconds."""

    name: str
    sound: Sound
    beats: FloatArray


def real_pieces() -> list[RealPiece]:
    """The pieces in `data-music` beside the folder of real clips. Skips the test without them."""
    files = sorted((real_clips().parent / "data-music").glob("*.json"))
    if not files:
        pytest.skip("PIECES OF MUSIC ABSENT: data-music beside the folder of real clips")
    return [
        RealPiece(
            file.stem,
            read_audio(file.with_suffix(".ogg").read_bytes()),
            np.array(json.loads(file.read_text())["beats"]),
        )
        for file in files
    ]
