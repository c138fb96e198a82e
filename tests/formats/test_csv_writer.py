"""CSV files have times and meters, and names that spreadsheets do not run as formulas."""

from __future__ import annotations

import csv
import io

import numpy as np

from app.formats.csv_writer import BLOCK_FRAMES, write_csv


def test_rows_are_times_and_positions() -> None:
    frames = BLOCK_FRAMES + 5
    positions = np.random.default_rng(0).normal(size=(frames, 2, 3)).astype(np.float32)
    text = b"".join(write_csv(["Hips", 'a, "b"\nc'], positions, 50.0)).decode()
    head, *rows = csv.reader(io.StringIO(text))
    assert head[:4] == ["time", "Hips_x", "Hips_y", "Hips_z"]
    assert head[4] == 'a, "b"\nc_x'
    numbers = np.array(rows, dtype=float)
    np.testing.assert_allclose(numbers[:, 0], np.arange(frames) / 50)
    np.testing.assert_allclose(numbers[:, 1:], positions.reshape(frames, 6), atol=1e-6)


def test_names_are_no_formulas() -> None:
    text = b"".join(write_csv(["=1+1", "@x", "+y", "-z"], np.zeros((1, 4, 3)), 30.0)).decode()
    head = next(csv.reader(io.StringIO(text)))
    assert not any(name.startswith(("=", "+", "-", "@")) for name in head)
