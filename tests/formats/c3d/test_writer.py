"""C3D files that ezc3d and our reader read back."""

from __future__ import annotations

from pathlib import Path

import ezc3d
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.formats.c3d.points import read_points
from app.formats.c3d.reader import read_c3d
from app.formats.c3d.writer import BLOCK, MAX_SHORT, write_c3d
from app.motion.canonical.up_axis import to_y_up
from app.numerics.arrays import FloatArray
from tests.people import CONVENTIONS, person


def written(names: list[str], positions: FloatArray, rate: float, **options: object) -> bytes:
    content = b"".join(write_c3d(names, positions, rate, **options))  # type: ignore[arg-type]
    assert len(content) % BLOCK == 0
    return content


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    positions=arrays(np.float32, st.tuples(st.integers(1, 5), st.integers(1, 6), st.just(3)),
                     elements=st.floats(-100, 100, width=32)),
    rate=st.floats(1, 2000, width=32),
    data=st.data(),
)  # fmt: skip
def test_our_reader_reads_any_positions(
    positions: FloatArray, rate: float, data: st.DataObject
) -> None:
    joints = positions.shape[1]
    names = data.draw(st.lists(st.text(max_size=60), min_size=joints, max_size=joints))
    points = read_points(written(names, positions, rate))
    assert points.frame_rate == pytest.approx(rate)
    assert points.cautions == ()
    assert len(set(points.labels)) == joints
    back = to_y_up(points.positions.astype(np.float64), "z")
    np.testing.assert_allclose(back, positions.astype(float) * 1000, rtol=1e-6, atol=2e-4)


def test_ezc3d_reads_the_same(tmp_path: Path) -> None:
    positions = np.random.default_rng(3).normal(size=(70, 300, 3))
    names = [f"joint {number}" for number in range(300)]
    file = tmp_path / "motion.c3d"
    file.write_bytes(written(names, positions, 120.0))
    found = ezc3d.c3d(str(file))
    points = found["data"]["points"]
    assert points.shape == (4, 300, 70)
    np.testing.assert_allclose(points[0].T, positions[..., 0] * 1000, rtol=1e-6)
    np.testing.assert_allclose(points[1].T, -positions[..., 2] * 1000, rtol=1e-6)
    np.testing.assert_allclose(points[2].T, positions[..., 1] * 1000, rtol=1e-6)
    parameters = found["parameters"]["POINT"]
    assert parameters["RATE"]["value"][0] == 120.0
    assert parameters["UNITS"]["value"] == ["mm"]
    assert parameters["Y_SCREEN"]["value"] == ["+Z"]
    labels = [*parameters["LABELS"]["value"], *parameters["LABELS2"]["value"]]
    assert labels == [f"joint_{number}" for number in range(300)]
    assert found["header"]["points"]["last_frame"] == 69
    assert found["data"]["meta_points"]["residuals"].min() == 0


def test_a_motion_longer_than_16_bits_count_is_whole() -> None:
    positions = np.ones((MAX_SHORT + 7, 1, 3), dtype=np.float32)
    points = read_points(written(["Hips"], positions, 100.0))
    assert len(points.positions) == MAX_SHORT + 7
    assert points.cautions == ()


def test_a_point_at_the_origin_is_seen() -> None:
    points = read_points(written(["Hips"], np.zeros((3, 1, 3)), 100.0))
    assert np.isfinite(points.positions).all()
    assert np.abs(points.positions).max() < 1e-3


def test_a_person_is_a_person_again() -> None:
    recording = person(CONVENTIONS["SMPL"], frames=20)
    names = list(recording.skeleton.names)
    content = written(names, recording.positions, 60.0, unit="m", units_per_meter=1.0)
    again = read_c3d(content)
    assert (again.metres_per_unit, again.up_axis, again.frame_rate) == (1.0, "z", 60.0)
