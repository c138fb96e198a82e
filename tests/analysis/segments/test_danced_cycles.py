from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.frame_features import features_at_10hz, frame_features
from app.analysis.segments.danced_cycles import POSES, danced_cycles
from app.analysis.segments.keypose_arrays import keypose_arrays
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of
from tests.cyclic_dances import CyclicDance, cyclic_dance


def _arrays(dance: CyclicDance) -> dict[str, FloatArray]:
    track = body_track(motion_of(dance.positions, dance.rate))
    features = features_at_10hz(frame_features(track), track.rate)
    frames = np.round(dance.stops * track.rate).astype(np.int64)
    return {"features_10hz": features} | keypose_arrays(frames, features)


@pytest.fixture(scope="module")
def arrays() -> dict[str, FloatArray]:
    return _arrays(cyclic_dance(3, poses=4, times=3, change=0.05))


def test_a_repeated_sequence_gives_its_cycles(arrays: dict[str, FloatArray]) -> None:
    found = danced_cycles(arrays)
    assert found.length == 4
    cycles = found.cycles()
    assert cycles.shape[1:] == (4, POSES, 13, 3)
    again = np.abs(cycles[1] - cycles[0]).mean()
    shifted = np.abs(found.cycles(1)[0] - cycles[0]).mean()
    assert again < 0.5 * shifted


def test_a_segment_begins_where_the_one_before_ends(arrays: dict[str, FloatArray]) -> None:
    segments = danced_cycles(arrays).segments
    np.testing.assert_allclose(segments[1:, 0], segments[:-1, -1], atol=1e-9)


def test_a_motion_without_repetition_is_one_segment(arrays: dict[str, FloatArray]) -> None:
    none = arrays | {"segment_cycles": np.zeros((0, 3), dtype=np.int32)}
    found = danced_cycles(none)
    assert (found.length, len(found.segments)) == (1, 1)
    whole = arrays["features_10hz"][[0, -1], :39].reshape(2, 13, 3)
    np.testing.assert_allclose(found.cycles()[0, 0, [0, -1]], whole, atol=1e-6)


def test_only_cycles_of_the_usual_number_of_segments_in_a_row_count(
    arrays: dict[str, FloatArray],
) -> None:
    spans = np.array([(0.2 * k, 0.2 * k + 0.2) for k in range(12)])
    cycles = np.array([(0, 2, 0), (2, 4, 0), (4, 7, 0), (7, 9, 0), (9, 11, 1)], dtype=np.int32)
    found = danced_cycles(arrays | {"segment_spans": spans, "segment_cycles": cycles})
    assert (found.length, len(found.segments)) == (2, 4)
    poses = arrays["features_10hz"][[0, 2, 4, 6], :39].reshape(4, 13, 3)
    np.testing.assert_allclose(found.segments[:, 0], poses, atol=1e-9)
