"""Points and paths as pictures."""

from __future__ import annotations

import numpy as np
import pytest

from app.evaluate.charts import Cloud, scatter_picture


@pytest.mark.parametrize("dimensions", [2, 3])
def test_the_same_points_give_the_same_bytes(dimensions: int) -> None:
    rng = np.random.default_rng(0)
    clouds = [
        Cloud(rng.normal(size=(10, dimensions)), "walk", labels=["a", "b$"]),
        Cloud(rng.normal(size=(5, dimensions)), "run", joined=True),
        Cloud(rng.normal(size=(1, dimensions)), "walk"),
    ]
    first = scatter_picture(clouds, "svg", title="space", axes=("x", "y", "z")[:dimensions])
    assert first.startswith(b"<?xml")
    again = scatter_picture(clouds, "svg", title="space", axes=("x", "y", "z")[:dimensions])
    assert first == again
    assert first != scatter_picture(clouds[:2], "svg", title="space")


def test_dimensions_that_cannot_be_drawn_are_refused() -> None:
    rng = np.random.default_rng(0)
    flat, deep = Cloud(rng.normal(size=(4, 2))), Cloud(rng.normal(size=(4, 3)))
    for clouds in ([], [flat, deep], [Cloud(rng.normal(size=(4, 4)))], [Cloud(np.zeros(3))]):
        with pytest.raises(ValueError, match="clouds"):
            scatter_picture(clouds, "svg")
