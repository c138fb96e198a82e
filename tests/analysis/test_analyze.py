"""The arrays of an analysis: their names, shapes and types; also of very short motions."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.analyze import analyze, describe_for_search
from app.analysis.array_shapes import SHAPES, is_usable
from app.analysis.descriptors.windows import WINDOW_SCALES, window_frames
from app.analysis.descriptors.word_windows import WORD_WINDOW_SPANS, WORD_WINDOWS
from app.analysis.keyposes.keyposes import T1, T2
from app.analysis.rhythm.rhythm import BEAT_ARRAYS
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, walking, waving

BODIES = {"walk": walking(turn=0.3), "wave": waving(), "still": standing(90), "two": standing(2)}

SEGMENT_TYPES = {
    "segment_spans": (np.float32, 2), "segment_vectors": (np.float16, 185),
    "segment_cycles": (np.int32, 3),
}  # fmt: skip


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
def test_every_array_has_its_shape(body: FloatArray) -> None:
    arrays = analyze(motion_of(body)).arrays
    assert arrays.keys() == SHAPES.keys()
    for name, array in arrays.items():
        assert is_usable(name, array), (name, array.shape)
        assert not is_usable(name, array[None]), name
    assert not is_usable("features_10hz", arrays["features_10hz"][:, 1:])


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
def test_arrays_are_finite_with_documented_shapes_and_types(body: FloatArray) -> None:
    arrays = dict(analyze(motion_of(body)).arrays)
    keyposes, thresholds = arrays.pop("keypose_frames"), arrays.pop("keypose_thresholds")
    beats = {name: arrays.pop(name) for name in BEAT_ARRAYS}
    windows = {scale: arrays.pop(scale.vectors) for scale in WINDOW_SCALES}
    spans = {scale: arrays.pop(scale.spans) for scale in WINDOW_SCALES}
    segments = {name: arrays.pop(name) for name in SEGMENT_TYPES}
    words = {name: arrays.pop(name) for name in (WORD_WINDOWS, WORD_WINDOW_SPANS)}
    n, states = len(body), len(arrays["symbol_means"])
    shapes = {
        "role_positions": (n, 13, 3), "features_10hz": ((n - 1) // 3 + 1, 82),
        "active_span": (2,),
        "motion_vector": (128,), "paced_vector": (128,), "wide_motion_vector": (512,),
        "msv_lambda": (1,), "msv_rho": (13,), "msv_epsilon": (n,),
        "msv_convergence": (len(arrays["msv_convergence"]), 2),
        "pose_cover": (len(arrays["pose_cover"]), 38),
        "moments": (len(arrays["moments"]), 33),
        "motion_sample": (1250,), "angle_sample": (642,), "motion_shape": (1378,),
        "symbol_statistics": (131,), "movement_signs": (44,), "symbol_means": (states, 26),
        "symbol_variances": (states, 26), "symbol_transitions": (states, states),
    }  # fmt: skip
    assert {name: array.shape for name, array in arrays.items()} == shapes
    assert all(array.dtype == np.float32 for array in arrays.values())
    assert all(np.isfinite(array).all() for array in arrays.values())
    assert all(a.dtype == np.float64 and np.isfinite(a).all() for a in beats.values())
    assert (beats["beat_times"].ndim, beats["beat_facts"].shape) == (1, (3,))
    assert (thresholds.dtype, thresholds.tolist()) == (np.float64, [T1, T2])
    assert (keyposes.dtype, keyposes.ndim) == (np.int32, 1)
    assert (np.diff(keyposes, prepend=-1, append=n) > 0).all()
    assert set(keyposes.tolist()) <= set(arrays["pose_cover"][:, 0].astype(int).tolist())
    assert {name: (a.dtype, a.shape[1]) for name, a in segments.items()} == SEGMENT_TYPES
    assert len(segments["segment_spans"]) == max(len(keyposes) - 1, 0)
    assert words[WORD_WINDOWS].dtype == np.float16
    assert words[WORD_WINDOW_SPANS].shape == (len(words[WORD_WINDOWS]), 2)
    for scale in WINDOW_SCALES:
        count = len(window_frames((n - 1) // 3 + 1, scale))
        assert (windows[scale].shape, windows[scale].dtype) == ((count, 125), np.float16)
        assert (spans[scale].shape, spans[scale].dtype) == ((count, 2), np.float32)


def test_the_same_motion_gives_the_same_bytes() -> None:
    one, other = (analyze(motion_of(BODIES["walk"])).arrays for _ in range(2))
    assert all(one[name].tobytes() == other[name].tobytes() for name in one)


def test_a_query_has_the_same_arrays_as_a_stored_clip() -> None:
    stored = analyze(motion_of(BODIES["walk"])).arrays
    query = describe_for_search(motion_of(BODIES["walk"])).arrays
    assert set(stored) - set(query) == {
        "keypose_frames", "pose_cover", "symbol_means", "symbol_variances", "symbol_transitions",
        "keypose_thresholds", "moments", WORD_WINDOWS, WORD_WINDOW_SPANS,
        *SEGMENT_TYPES, *BEAT_ARRAYS,
    }  # fmt: skip
    assert all(stored[name].tobytes() == query[name].tobytes() for name in query)


def test_only_the_requested_arrays_are_computed() -> None:
    motion = motion_of(BODIES["walk"])
    every = describe_for_search(motion).arrays
    for names in (("features_10hz",), ("motion_vector", "window_spans_1s"), tuple(every)):
        some = describe_for_search(motion, names).arrays
        assert tuple(some) == names
        assert all(some[name].tobytes() == every[name].tobytes() for name in names)
    symbol = describe_for_search(motion, ["symbol_means"]).arrays["symbol_means"]
    assert symbol.tobytes() == analyze(motion).arrays["symbol_means"].tobytes()
    with pytest.raises(KeyError, match="pose_cover"):
        describe_for_search(motion, ["pose_cover"])
