"""Windows in which words are looked for: each is described as its part of the motion alone."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.movement_signs import movement_signs
from app.analysis.descriptors.sign_series import SignSeries
from app.analysis.descriptors.word_windows import (
    INPUT_WIDTH,
    WORD_WINDOW_SPANS,
    WORD_WINDOWS,
    first_frames,
    word_inputs,
    word_window_arrays,
)
from app.analysis.symbols.channels import symbol_features, symbol_statistics
from app.motion.frame.body_frame import smooth_track
from tests.bodies import motion_of, walking


def test_windows_are_those_of_a_slow_twin() -> None:
    track = smooth_track(motion_of(walking(7.0)))
    channels = symbol_features(track)
    firsts = first_frames(track.frames, 60, 15)
    found = word_inputs(track, channels, firsts, 60)
    expected = [
        np.concatenate(
            [
                symbol_statistics(channels[first : first + 60], track.rate),
                movement_signs(track.part(first, first + 60)),
            ]
        )
        for first in firsts.tolist()
    ]
    assert found == pytest.approx(np.array(expected))


@pytest.mark.parametrize("seconds", [0.2, 1.0, 2.0, 3.9, 9.3])
def test_windows_cover_the_motion(seconds: float) -> None:
    track = smooth_track(motion_of(walking(seconds)))
    arrays = word_window_arrays(SignSeries(track), symbol_features(track))
    spans = arrays[WORD_WINDOW_SPANS]
    assert arrays[WORD_WINDOWS].shape == (len(spans), INPUT_WIDTH)
    assert np.isfinite(arrays[WORD_WINDOWS].astype(np.float32)).all()
    assert spans.min() == 0.0
    assert spans.max() == pytest.approx(track.duration)
    assert (np.diff(spans, axis=1) > 0).all()
