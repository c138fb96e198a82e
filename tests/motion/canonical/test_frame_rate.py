"""Only frame rates that are impossible for a body give a caution."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from app.formats.bvh.reader import read_bvh
from app.motion.canonical import frame_rate
from app.motion.canonical.canonical import canonicalize
from app.motion.canonical.frame_rate import judge_frame_rate
from app.numerics.arrays import FloatArray
from tests.bodies import standing, walking, waving
from tests.real_clips import manifest, real_clips


def jumping(rate: float) -> FloatArray:
    """(frames, 13, 3) a jump with a flight of half a second, at 9.81 m/s2."""
    t = np.arange(round(2 * rate)) / rate
    airborne = np.clip(t - 0.75, 0, 0.5)
    height = 0.5 * 9.81 * airborne * (0.5 - airborne)
    body = standing(len(t)).copy()
    body[..., 1] += height[:, None]
    return body


@pytest.mark.parametrize("body", [standing(200), walking(6), waving(6), jumping(60)])
def test_plausible_frame_rates_give_no_caution(body: FloatArray) -> None:
    rate = 60.0 if len(body) == 120 else 30.0
    assert judge_frame_rate(body, rate) == []


@pytest.mark.parametrize("factor", [0.25, 0.5, 2.0, 4.0])
def test_free_fall_gives_the_true_rate(factor: float) -> None:
    (caution,) = judge_frame_rate(jumping(60), 60 * factor)
    assert caution.code == "frame_rate_suspect"
    assert caution.likely == 60


def test_sliding_to_and_fro_gives_a_caution() -> None:
    body = standing(400).copy()
    t = np.arange(400) / 60
    body[..., 0] += 0.25 * np.sin(2 * np.pi * t)[:, None]  # 1 g at most, .7 g for half the time
    (caution,) = judge_frame_rate(body, 60)
    assert caution.likely == 30


def test_nine_steps_a_second_give_a_caution() -> None:
    body = walking(8, rate=120, steps_hz=4.5, speed=2.0)
    (caution,) = judge_frame_rate(body, 120)
    assert caution.likely is not None
    assert caution.likely < 120


@pytest.mark.parametrize("true", [24.0, 30.0, 60.0])
@pytest.mark.parametrize("said", [1.0, 1.5])
def test_steps_of_many_seconds_give_a_caution(true: float, said: float) -> None:
    """A frame time of 1 is often a frame number."""
    (caution,) = judge_frame_rate(walking(6, rate=true), said)
    assert "a step takes" in caution.detail
    assert caution.likely == pytest.approx(true, rel=0.35)


@pytest.mark.parametrize("pace", [0.1, 0.5, 1.0])
def test_slow_and_usual_steps_give_none(pace: float) -> None:
    body = walking(8 / pace, rate=30, steps_hz=pace, speed=0.6 * pace)
    assert judge_frame_rate(body, 30) == []


def test_laws_that_need_meters_are_left_out_if_the_unit_is_a_guess() -> None:
    assert judge_frame_rate(2.2 * jumping(60), 60) != []
    assert judge_frame_rate(2.2 * jumping(60), 60, is_unit_sure=False) == []


def test_a_dance_of_hops_needs_no_grip() -> None:
    """Near flights the load of the feet is small, so that its share to the side seems large."""
    body = standing(600).copy()
    t = np.arange(600) / 60
    body[..., 1] += 0.05 * np.sin(2 * np.pi * 2.2 * t)[:, None]  # 1 g up and down
    body[..., 0] += 0.02 * np.sin(2 * np.pi * 2.2 * t)[:, None]  # .4 g to the sides
    assert judge_frame_rate(body, 60) == []


@pytest.mark.parametrize("frames", [1, 2, 5, 30])
def test_short_clips_are_not_checked_by_all_laws(frames: int) -> None:
    assert judge_frame_rate(standing(frames), 30) == []


@pytest.mark.parametrize("rate", [1.0, 2.0, 7.3, 29.97, 2000.0])
@pytest.mark.parametrize("frames", [1, 3, 40, 500])
def test_any_rate_and_length_raises_no_error(rate: float, frames: int) -> None:
    noise = np.random.default_rng(0).normal(size=(frames, 13, 3))
    for caution in judge_frame_rate(noise, rate):
        assert caution.likely is not None
        assert np.isfinite(caution.likely)


def test_the_wrong_rates_of_the_salsa_clips_are_found() -> None:
    for number in (1, 2, 3):
        content = (real_clips() / "cmu-daz" / f"salsa_0{number}.bvh").read_bytes()
        motion = canonicalize(read_bvh(content))
        suspect = [caution for caution in motion.cautions if caution.code == "frame_rate_suspect"]
        assert [caution.likely for caution in suspect] == [60]
        assert motion.frame_rate == 120


@pytest.mark.slow
def test_no_other_real_clip_gets_a_caution() -> None:
    blamed = []
    for row in manifest():
        if not row["path"].endswith(".bvh"):
            continue
        motion = canonicalize(read_bvh((real_clips() / row["path"]).read_bytes()))
        suspect = any(caution.code == "frame_rate_suspect" for caution in motion.cautions)
        if suspect != (abs(motion.frame_rate - float(row["fps"])) > 1):
            blamed.append(row["path"])
    assert blamed == []


@pytest.mark.parametrize("frames", [6, 29, 30, 31, 200])
@pytest.mark.parametrize("shape", [(3,), (2, 3)])
@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
def test_the_filter_is_that_of_scipy(frames: int, shape: tuple[int, ...], rate: float) -> None:
    samples = np.random.default_rng(frames).normal(size=(frames, *shape))
    sections = scipy.signal.butter(2, frame_rate.CUTOFF, fs=rate, output="sos")
    padding = min(frames - 1, round(rate))
    expected = scipy.signal.sosfiltfilt(sections, samples, axis=0, padlen=padding)
    found = frame_rate._low_pass(samples, rate, frame_rate.CUTOFF)
    np.testing.assert_allclose(found, expected, atol=1e-12)
