"""TRC files by the rules by which OpenSim reads them."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.formats.trc.writer import BLOCK_FRAMES, write_trc
from app.numerics.arrays import FloatArray
from tests.formats.trc.files import opensim


@settings(max_examples=40, deadline=None)
@given(
    positions=arrays(np.float32, st.tuples(st.integers(1, 4), st.integers(1, 5), st.just(3)),
                     elements=st.floats(-100, 100, width=32)),
    rate=st.floats(1, 2000),
    data=st.data(),
)  # fmt: skip
def test_what_is_written_is_read(positions: FloatArray, rate: float, data: st.DataObject) -> None:
    joints = positions.shape[1]
    names = data.draw(st.lists(st.text(max_size=60), min_size=joints, max_size=joints))
    meta, labels, times, found = opensim(b"".join(write_trc(names, positions, rate)))
    assert meta["Units"] == "mm"
    assert len({label.lower() for label in labels}) == joints
    assert not any(char.isspace() for label in labels for char in label)
    np.testing.assert_allclose(float(meta["DataRate"]), rate, rtol=1e-8)
    np.testing.assert_allclose(times, np.arange(len(positions)) / rate, atol=1e-6)
    np.testing.assert_allclose(found, positions.astype(float) * 1000, atol=1e-6)


def test_many_frames_and_other_units() -> None:
    positions = np.random.default_rng(0).normal(size=(BLOCK_FRAMES + 3, 2, 3))
    content = b"".join(write_trc(["Hips", "Hips"], positions, 60.0, unit="m", units_per_meter=1.0))
    meta, labels, _, found = opensim(content)
    assert (meta["Units"], labels) == ("m", ["Hips", "Hips_2"])
    np.testing.assert_allclose(found, positions, atol=1e-6)
