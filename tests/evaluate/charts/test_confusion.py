"""Confusion matrices as pictures."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread

from app.evaluate.charts import Format, confusion, confusion_picture, confusions_picture
from app.evaluate.charts.drawing import MAX_INCHES

SIGNATURES: dict[Format, bytes] = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}


@pytest.mark.parametrize("form", SIGNATURES)
def test_the_same_matrix_gives_the_same_bytes(form: Format) -> None:
    shares = np.array([[0.9, 0.1], [0.3, 0.7]])
    first = confusion_picture(shares, ["walk", "run"], form, title="k = 20")
    assert first.startswith(SIGNATURES[form])
    assert first == confusion_picture(shares, ["walk", "run"], form, title="k = 20")
    assert first != confusion_picture(shares.T, ["walk", "run"], form, title="k = 20")


def test_names_with_special_characters_are_drawn_unchanged() -> None:
    names = ["$\\frac{", "_hidden", "バイバイ", "<b>&amp;", "n" * 300, ""]
    picture = confusion_picture(np.eye(6), names, "svg")
    assert b"<b>" not in picture


def test_cells_with_large_shares_are_dark() -> None:
    pixels = imread(io.BytesIO(confusion_picture(np.eye(3), ["a", "b", "c"], "png")))
    dark = (pixels[..., 2] > 0.3) & (pixels[..., 0] < 0.1)
    assert 0.02 < dark.mean() < 0.3  # a third of the cells, and the bar's end


def test_matrices_of_the_same_classes_are_drawn_side_by_side() -> None:
    def width(count: int) -> int:
        matrices = {f"method {i}": np.eye(3) for i in range(count)}
        picture = confusions_picture(matrices, ["a", "b", "c"], "png")
        return int(imread(io.BytesIO(picture)).shape[1])

    assert width(3) > 1.6 * width(1)
    with pytest.raises(ValueError, match="one row and one column"):
        confusions_picture({"one": np.eye(2), "other": np.eye(3)}, ["a", "b"], "svg")
    with pytest.raises(ValueError, match="one row and one column"):
        confusions_picture({}, ["a", "b"], "svg")


@pytest.mark.slow
def test_many_classes_still_fit_a_page() -> None:
    picture = confusion_picture(np.eye(100), [f"class {i}" for i in range(100)], "png")
    height, width = imread(io.BytesIO(picture)).shape[:2]
    assert 2000 < height < 6500
    assert 2000 < width < 6500


def test_wrong_shapes_are_refused() -> None:
    for shares, names in ((np.eye(2), ["a"]), (np.zeros((0, 0)), []), (np.ones((2, 3)), "ab")):
        with pytest.raises(ValueError, match="one row and one column"):
            confusion_picture(shares, list(names), "svg")


@pytest.mark.parametrize(
    ("count", "beside"), [(5, 1), (41, 8), pytest.param(300, 1, marks=pytest.mark.slow)]
)
def test_names_do_not_overlap(monkeypatch: pytest.MonkeyPatch, count: int, beside: int) -> None:
    heights: list[float] = []

    def measured(
        draw: Callable[[Figure], None], inches: tuple[float, float], form: Format
    ) -> bytes:
        width, height = (min(side, MAX_INCHES) for side in inches)
        figure = Figure(figsize=(width, height), layout="constrained")
        draw(figure)
        FigureCanvasAgg(figure).draw()
        names = [name.get_window_extent() for name in figure.axes[0].get_yticklabels()]
        assert len(names) == count
        pairs = zip(names[1:], names, strict=False)  # from below upwards: the axis is inverted
        assert all(lower.y1 <= upper.y0 for lower, upper in pairs)
        heights.extend(name.height * 72 / figure.dpi for name in names)
        return form.encode()

    monkeypatch.setattr(confusion, "rendered", measured)
    shares = {str(place): np.eye(count) for place in range(beside)}
    confusions_picture(shares, [f"walk-left-{number}" for number in range(count)], "svg")
    assert min(heights) > 3.0  # points: small, and still letters


def test_sizes_stand_beside_the_names_of_the_rows() -> None:
    matrices = {"msv-dtw": np.eye(2)}
    counted = confusions_picture(matrices, ["walk", "run"], "svg", sizes=[31, 7])
    assert counted != confusions_picture(matrices, ["walk", "run"], "svg")
