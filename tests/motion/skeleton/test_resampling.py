"""Resampling: number of samples, first sample, exactness, no aliasing, no loss."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.deadline import Deadline, within
from app.errors import ClientLeft
from app.motion.skeleton import resampling
from app.motion.skeleton.resampling import low_pass, resample, resample_to, sample_at
from app.numerics.arrays import FloatArray


@given(frames=st.integers(1, 400), source=st.floats(5, 240), target=st.floats(5, 240))
@settings(max_examples=100, deadline=None)
def test_straight_movement_stays_straight(frames: int, source: float, target: float) -> None:
    line = np.arange(frames)[:, None] / source * np.array([1.0, -2.0]) + 5.0
    found = resample(line, source, target)
    if source != target:
        assert len(found) == int((frames - 1) / source * target + 1e-6) + 1
    expected = np.arange(len(found))[:, None] / target * np.array([1.0, -2.0]) + 5.0
    np.testing.assert_allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("source", [24.0, 25.0, 29.97, 50.0, 60.0, 100.0, 120.0, 240.0])
def test_a_movement_of_3_hz_is_the_same_from_any_rate(source: float) -> None:
    def at(times: np.ndarray) -> np.ndarray:
        return np.sin(2 * np.pi * 3 * times)

    found = resample(at(np.arange(int(4 * source) + 1) / source), source, 30.0)
    expected = at(np.arange(len(found)) / 30.0)
    assert np.abs(found - expected)[5:-5].max() < (0.05 if source < 30 else 0.01)


def test_high_frequencies_do_not_alias() -> None:
    t = np.arange(481) / 120
    found = resample(np.sin(2 * np.pi * 28 * t), 120.0, 30.0)
    assert np.abs(found[10:-10]).max() < 0.02


def test_the_first_sample_the_type_and_the_shape_do_not_change() -> None:
    samples = np.random.default_rng(0).normal(size=(50, 13, 3)).astype(np.float32)
    found = resample(samples, 120.0, 30.0)
    assert found.dtype == np.float32
    assert found.shape == (13, 13, 3)
    np.testing.assert_allclose(found[0], samples[0], atol=1e-5)


def test_the_same_rate_and_single_frames_are_copied() -> None:
    samples = np.ones((4, 2))
    found = resample(samples, 30.0, 30.0)
    found[0] = 7
    assert (samples == 1).all()
    assert resample(np.ones((1, 3)), 10.0, 30.0).shape == (1, 3)
    assert resample(np.ones((2, 3)), 120.0, 30.0).shape == (1, 3)


def test_a_count_of_samples_includes_both_ends() -> None:
    ramp = np.linspace(0.0, 9.0, 40)[:, None]
    np.testing.assert_allclose(resample_to(ramp, 10)[:, 0], np.arange(10.0), atol=1e-9)
    assert resample_to(np.ones((1, 2)), 5).shape == (5, 2)
    assert resample_to(ramp, 1).shape == (1, 1)


def test_times_outside_the_clip_give_its_ends() -> None:
    np.testing.assert_allclose(sample_at(np.array([1.0, 2.0, 4.0]), np.array([-3.0, 9.0])), [1, 4])


def test_a_rate_must_be_positive() -> None:
    with pytest.raises(ValueError, match="positive"):
        resample(np.ones((3, 1)), 0.0, 30.0)


@given(frames=st.integers(9, 700), count=st.integers(1, 40), single=st.booleans())
@settings(max_examples=40, deadline=None)
def test_few_times_of_a_long_clip_agree_with_the_filtered_whole(
    frames: int, count: int, single: bool
) -> None:
    kind = np.float32 if single else np.float64
    samples = np.random.default_rng(frames).normal(size=(frames, 2, 3)).astype(kind)
    step = (frames - 1) / max(count - 1, 1)
    whole = sample_at(low_pass(samples, step), np.arange(count) * step)
    found = resample_to(samples, count)
    assert found.dtype == kind
    np.testing.assert_allclose(found, whole, atol=1e-5 if single else 1e-12)


def naive_resample(samples: FloatArray, ratio: float, count: int) -> FloatArray:
    """All frames are filtered by the whole filter, one by one, and then read."""
    reach = int(np.ceil(resampling.LOW_PASS_REACH * ratio))
    offsets = np.arange(-reach, reach + 1)
    kernel = np.sinc(offsets / ratio) * np.cos(0.5 * np.pi * offsets / (reach + 1)) ** 2
    around = np.pad(samples, [(reach, reach), (0, 0)], mode="reflect", reflect_type="odd")
    smooth = [kernel / kernel.sum() @ around[i : i + 2 * reach + 1] for i in range(len(samples))]
    return sample_at(np.array(smooth), np.arange(count) * ratio)


@given(frames=st.integers(2, 300), ratio=st.floats(1.01, 400.0))
@settings(max_examples=60, deadline=None)
def test_any_ratio_of_rates_agrees_with_the_naive_twin(frames: int, ratio: float) -> None:
    samples = np.random.default_rng(frames).normal(size=(frames, 2))
    found = resample(samples, ratio, 1.0)
    np.testing.assert_allclose(found, naive_resample(samples, ratio, len(found)), atol=1e-9)


def test_a_long_filter_is_not_applied_to_the_whole_clip(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    taps: list[int] = []

    def counted(samples: FloatArray, kernel: FloatArray, axis: int) -> FloatArray:
        taps.append(len(kernel))
        return samples

    monkeypatch.setattr("scipy.ndimage.convolve1d", counted)
    samples = np.zeros((20_000, 3))
    for rate in (1.0, 5.0, 60.0, 100.0, 500.0, 999.0):
        resample(samples, 1000.0, rate)
    assert max(taps) <= 2 * resampling.LOW_PASS_REACH * resampling.MIN_FAR_RATIO + 1


def test_the_size_of_blocks_does_not_change_the_result(monkeypatch: pytest.MonkeyPatch) -> None:
    samples = np.random.default_rng(0).normal(size=(500, 4, 3)).astype(np.float32)
    whole = [resample(samples, 120.0, rate) for rate in (30.0, 100.0, 240.0)]
    monkeypatch.setattr(resampling, "NUMBERS_AT_ONCE", 200)
    for rate, expected in zip((30.0, 100.0, 240.0), whole, strict=True):
        np.testing.assert_array_equal(resample(samples, 120.0, rate), expected)


def test_the_deadline_is_checked_between_blocks() -> None:
    with within(Deadline()) as deadline:
        deadline.abandon()
        for rate in (1.0, 30.0, 500.0):
            with pytest.raises(ClientLeft):
                resample(np.zeros((100, 3)), 120.0, rate)
