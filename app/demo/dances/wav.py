"""Writes WAV files with the standard library, because the demo must work without soundfile."""

from __future__ import annotations

import io
import wave

import numpy as np

from app.numerics.arrays import FloatArray


def write_wav(samples: FloatArray, sample_rate: int) -> bytes:
    """A mono WAV file of 16 bits with `samples` (n,) from -1 to 1; larger values are cut off."""
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(sample_rate)
        out.writeframes(np.round(np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes())
    return file.getvalue()
