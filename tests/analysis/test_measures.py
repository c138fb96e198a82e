"""The measures of motions whose way, speed and tempo are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.energy.energy import energies
from app.analysis.measures import Measures, measure
from app.motion.frame.body_frame import BodyTrack, body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, walking, waving


def measured(body: FloatArray, rate: float = 30.0, tempo: float | None = None) -> Measures:
    track: BodyTrack = body_track(motion_of(body, rate))
    return measure(track, energies(track), tempo)


def test_a_straight_way_has_its_length_and_speed() -> None:
    body = standing(91)
    body[:, :, 2] += np.linspace(0, 4.5, 91)[:, None]
    found = measured(body)
    assert found.travel == pytest.approx(4.5, rel=0.01)
    assert found.speed == pytest.approx(1.5, rel=0.01)


def test_ways_forth_and_back_add_up_and_jumps_do_not_count() -> None:
    body = standing(181)
    body[:, :, 0] += 2 * np.abs(np.linspace(-1, 1, 181))[:, None]
    body[:, :, 1] += np.sin(np.linspace(0, 20, 181))[:, None]
    assert measured(body).travel == pytest.approx(4, rel=0.05)


def test_noise_of_markers_is_no_way() -> None:
    body = standing(300)
    body += np.random.default_rng(0).normal(scale=0.002, size=body.shape)
    assert measured(body).speed < 0.02


def test_place_and_heading_change_nothing() -> None:
    body = walking()
    one, moved = measured(body), measured(turned_about_y(body, 2.0) + np.array([3.0, 0.0, -4.0]))
    for name in ("travel", "speed", "energy"):
        assert getattr(moved, name) == pytest.approx(getattr(one, name), rel=1e-3)


def test_faster_motion_has_more_energy() -> None:
    still, slow, fast = (
        measured(body).energy for body in (standing(120), waving(hz=0.5), waving(hz=2.0))
    )
    assert still == pytest.approx(0, abs=1e-6)
    assert still < slow < fast


def test_the_tempo_is_that_of_the_beats() -> None:
    assert measured(waving(), tempo=96.0).tempo == 96.0
    assert measured(waving()).tempo is None
