"""What the word model reads of overlapping windows of a motion, so that words find its parts.

The windows are 2 s and 4 s long (`WORD_WINDOWS`). Each is described as a clip is: by the statistics
of its symbol's channels, and by its signs of movement. Short windows have exact bounds, long ones
are recognized better: words are looked for in both. On real clips joined end to end, both together
are better than any single length from 1 to 4 s (`tests/bench/test_moments.py`).
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.movement_signs import SIGNS, signs_of_parts
from app.analysis.descriptors.sign_series import SignSeries
from app.analysis.symbols.channels import CHANNELS, statistics_of_parts
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray, IntArray

WORD_WINDOWS, WORD_WINDOW_SPANS = "word_windows", "word_window_spans"
"""The names of the two arrays."""

SECONDS = ((2.0, 0.5), (4.0, 1.0))
"""The length of windows and the time from one to the next, in seconds."""

INPUT_WIDTH = 5 * len(CHANNELS) + 1 + len(SIGNS)
"""The length of an input of the word model: 175."""

PARTS_AT_ONCE = 128
"""Windows that are described at a time. It bounds the memory to 30 MB."""


def word_window_arrays(series: SignSeries, channels: FloatArray) -> dict[str, FloatArray]:
    """The two arrays, for the series of a track of n frames and its channels (n, 26).

    word_windows: (w, 175) float16. word_window_spans: (w, 2) float32, start and end in seconds.
    """
    rate, count = series.rate, series.frames
    inputs, spans = [], []
    for seconds, hop in SECONDS:
        frames = min(round(seconds * rate), count)
        firsts = first_frames(count, frames, round(hop * rate))
        inputs.append(_inputs(series, channels, firsts, frames))
        spans.append(np.stack([firsts, firsts + frames], axis=1) / rate)
    return {
        WORD_WINDOWS: np.vstack(inputs).astype(np.float16),
        WORD_WINDOW_SPANS: np.vstack(spans).astype(np.float32),
    }


def first_frames(count: int, frames: int, hop: int) -> IntArray:
    """(w,) the first frame of each window of a motion of `count` frames; the last one ends it."""
    last = count - frames
    firsts = np.arange(0, last + 1, hop)
    return firsts if firsts[-1] == last else np.append(firsts, last)


def word_inputs(
    track: BodyTrack, channels: FloatArray, firsts: IntArray, frames: int
) -> FloatArray:
    """(w, 175) the inputs of the word model for parts of a motion.

    channels: (n, 26) of the track; firsts: (w,) the first frame of each part; frames: the length of
    each, at least 2.
    """
    return _inputs(SignSeries(track), channels, firsts, frames)


def _inputs(series: SignSeries, channels: FloatArray, firsts: IntArray, frames: int) -> FloatArray:
    found = [np.zeros((0, INPUT_WIDTH))]
    for some in np.split(firsts, range(PARTS_AT_ONCE, len(firsts), PARTS_AT_ONCE)):
        statistics = statistics_of_parts(channels, series.rate, some, frames)
        found.append(np.hstack([statistics, signs_of_parts(series, some, frames)]))
    return np.vstack(found)
