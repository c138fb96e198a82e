from __future__ import annotations

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS
from app.models.synthesis.timing import (
    medoid,
    moments_of_shapes,
    to_own_time,
    warp_to_groups,
    warp_to_references,
)
from app.numerics.arrays import FloatArray

HAND = 38  # the right hand's way forward


def gesture(at: float, *, height: float = 1.0, cyclic: bool = False) -> FloatArray:
    """(1378,) a still body of which one hand goes out and back at moment `at`."""
    moments = np.zeros((SAMPLES, CHANNELS))
    moments[:, HAND] = height * np.exp(-0.5 * ((np.arange(SAMPLES) - at) / 2.0) ** 2)
    return np.concatenate([moments.ravel(), [np.log(3.0), float(cyclic)]])


def hand(shapes: FloatArray) -> FloatArray:
    return moments_of_shapes(np.atleast_2d(shapes))[:, :, HAND]


def one_group(shapes: list[FloatArray]) -> tuple[FloatArray, np.ndarray]:
    return np.stack(shapes), np.zeros(len(shapes), dtype=np.int64)


def test_the_mean_of_gestures_at_other_times_is_a_gesture_at_the_mean_time() -> None:
    shapes, group = one_group([gesture(at) for at in (12, 15, 18)])
    timed = warp_to_groups(shapes, group)
    mean = hand(timed.shapes.mean(axis=0))[0]
    assert hand(shapes.mean(axis=0)).max() < 0.75
    assert mean.max() > 0.9
    assert abs(int(mean.argmax()) - 15) <= 1
    np.testing.assert_allclose(timed.timing[:, 15], [-3, 0, 3], atol=1.0)
    np.testing.assert_allclose(timed.timing.mean(axis=0), 0, atol=0.3)


def test_each_take_is_warped_back_to_its_own_time() -> None:
    shapes, group = one_group([gesture(at) for at in (12, 15, 18)])
    timed = warp_to_groups(shapes, group)
    for shape, aligned, timing in zip(shapes, timed.shapes, timed.timing, strict=True):
        back = to_own_time(aligned, timing)
        assert np.abs(hand(back) - hand(shape)).max() < 0.15
        np.testing.assert_array_equal(back[-2:], shape[-2:])


def test_groups_are_independent() -> None:
    early, late = [gesture(at) for at in (8, 10)], [gesture(at, height=2) for at in (20, 23)]
    both = warp_to_groups(np.stack([early[0], late[0], early[1], late[1]]), np.array([4, 9, 4, 9]))
    alone = warp_to_groups(*one_group(early))
    np.testing.assert_allclose(both.shapes[[0, 2]], alone.shapes, atol=1e-12)
    np.testing.assert_allclose(both.timing[[0, 2]], alone.timing, atol=1e-12)


def test_cycles_and_single_takes_stay_as_they_are() -> None:
    shapes = np.stack(
        [gesture(10), gesture(14, cyclic=True), gesture(12), gesture(20), gesture(23)]
    )
    timed = warp_to_groups(shapes, np.array([0, 0, 1, 2, 2]))
    np.testing.assert_array_equal(timed.shapes[:3], shapes[:3])
    assert not timed.timing[:3].any()
    assert timed.timing[3:].any()


def test_posture_does_not_affect_the_timing() -> None:
    shapes, group = one_group([gesture(at) for at in (12, 16, 17)])
    moments_of_shapes(shapes)[:] += np.linspace(0, 1, SAMPLES)[:, None]  # nowhere still
    other = shapes.copy()
    moments_of_shapes(other)[1] += np.random.default_rng(0).normal(size=CHANNELS)
    np.testing.assert_allclose(
        warp_to_groups(other, group).timing, warp_to_groups(shapes, group).timing, atol=1e-9
    )


def test_a_take_is_warped_to_the_time_of_a_reference() -> None:
    timed = warp_to_references(
        np.stack([gesture(18), gesture(18)]), np.stack([gesture(15), gesture(9)])
    )
    assert abs(int(hand(timed.shapes)[0].argmax()) - 15) <= 1
    assert abs(timed.timing[0, 15] - 3) < 1
    cyclic = gesture(15, cyclic=True)[None]
    for shape, reference in ((cyclic, gesture(9)[None]), (gesture(9)[None], cyclic)):
        still = warp_to_references(shape, reference)
        np.testing.assert_array_equal(still.shapes, shape)
        assert not still.timing.any()


def test_the_medoid_is_nearest_to_all_others() -> None:
    rows = np.array([[0.0, 0.0], [1.0, 0.0], [5.0, 0.0], [1.0, 1.0]])
    assert medoid(rows) == 1
    assert medoid(rows[:1]) == 0
    assert medoid(rows[[2, 0]]) == 0  # of two the first


def test_smoothed_times_change_less() -> None:
    late, usual = np.stack([gesture(20)]), np.stack([gesture(15)])
    pace = [np.diff(warp_to_references(late, usual, s).timing[0]) for s in (0.0, 2.0, 4.0)]
    assert np.abs(pace[0]).max() > np.abs(pace[1]).max() > np.abs(pace[2]).max()
