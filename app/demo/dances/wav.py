"""Writes WAV files without the audio library, because the demo must work without it."""

from __future__ import annotations

import io
import wave

import numpy as np

from app.numerics.arrays import FloatArray


def write_wav(samples: FloatArray, sample_rate: int) -> bytes:
    """Mono WAV, 16 bits, of `samples` (n,) within -1..1; what is beyond is cut off."""
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(sample_rate)
        out.writeframes(np.round(np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes())
    return file.getvalue()
