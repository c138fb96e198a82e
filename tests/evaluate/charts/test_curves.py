"""Curves as pictures."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.text import Text

from app.evaluate.charts import Curve, Panel, curves_picture


def _panel(groups: list[str]) -> Panel:
    x = np.arange(20.0)
    curves = [Curve(x, np.sin(x / 3 + i), group) for i, group in enumerate(groups)]
    return Panel(curves, "waves", "seconds", "height", marked=[3.0])


def test_the_same_curves_give_the_same_bytes() -> None:
    panels = [_panel(["walk", "run"]), _panel(["run", "_odd $name"])]
    first = curves_picture(panels, "svg", title="two")
    assert first.startswith(b"<?xml")
    assert first == curves_picture(panels, "svg", title="two")


def test_more_panels_make_a_larger_picture() -> None:
    def size(count: int) -> tuple[int, int]:
        picture = curves_picture([_panel(["walk"])] * count, "png")
        height, width = imread(io.BytesIO(picture)).shape[:2]
        return width, height

    one, three = size(1), size(3)
    assert three[0] > 1.7 * one[0]
    assert three[1] > 1.7 * one[1]


def test_ranges_ticks_and_logarithmic_axes_are_used() -> None:
    curve = Curve(np.arange(3.0), np.array([1.0, 1e-3, 1e-6]))
    plain = curves_picture([Panel([curve])], "svg")
    for panel in (
        Panel([curve], log_y=True),
        Panel([curve], y_range=(0.0, 1.0)),
        Panel([curve], ticks=["hips", "neck", "head"]),
        Panel([]),
    ):
        assert curves_picture([panel], "svg") != plain


def test_powers_of_ten_are_written_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    texts: list[str] = []
    draw = Text.draw

    def noted(text: Text, *args: object, **kwargs: object) -> None:
        texts.append(text.get_text())
        draw(text, *args, **kwargs)

    monkeypatch.setattr(Text, "draw", noted)
    curve = Curve(np.arange(3.0), np.array([1.0, 1e-3, 1e-6]), "a $name$")
    curves_picture([Panel([curve], log_y=True)], "svg")
    assert "1e\N{MINUS SIGN}06" in texts
    assert [text for text in texts if "$" in text and text != "a $name$"] == []


def test_a_picture_without_panels_is_refused() -> None:
    with pytest.raises(ValueError, match="panel"):
        curves_picture([], "svg")
