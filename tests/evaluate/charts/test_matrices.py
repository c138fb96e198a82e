"""Self-similarity matrices and motion volumes as pictures."""

from __future__ import annotations

import numpy as np
import pytest

from app.evaluate.charts import Format, Slices, matrices_picture, volumes_picture

NAMES = ["knee", "foot", "head"]
ROW = Slices(np.random.default_rng(0).random((4, 3, 3)), np.arange(4.0))
SHORT = Slices(ROW.matrices[:2], ROW.times[:2])


@pytest.mark.parametrize("form", ["svg", "png", "pdf"])
def test_the_same_matrices_give_the_same_bytes(form: Format) -> None:
    rows = {"walk": ROW, "$run": SHORT}
    for draw in (
        lambda some: matrices_picture(some, NAMES, form, title="SSM", label="distance"),
        lambda some: volumes_picture(some, form, title="MSV"),
    ):
        assert draw(rows) == draw(rows)
        assert draw(rows) != draw({"walk": ROW, "$run": ROW})


def test_equal_joints_are_drawn_too() -> None:
    still = {"rest": Slices(np.zeros((1, 3, 3)), np.zeros(1))}
    assert matrices_picture(still, NAMES, "svg", title="", label="").startswith(b"<?xml")
    assert volumes_picture(still, "svg", title="").startswith(b"<?xml")


def test_no_matrix_is_no_picture() -> None:
    with pytest.raises(ValueError, match="needs a matrix"):
        volumes_picture({}, "svg", title="")
