"""The common parts of all pictures."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from app.errors import BadField, ExtraNeeded
from app.evaluate.charts import confusion_picture, format_of, need_plots
from app.evaluate.charts.drawing import MAX_NAME_LENGTH, color, dashes, marker, shown


def test_the_suffix_selects_the_format() -> None:
    assert format_of(Path("a/b.SVG")) == "svg"
    assert format_of(Path("b.png")) == "png"
    assert format_of(Path("b.tar.pdf")) == "pdf"
    for bad in ("b.jpg", "b", "svg"):
        with pytest.raises(BadField, match=r"\.svg, \.png, \.pdf"):
            format_of(Path(bad))


def test_without_matplotlib_the_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ExtraNeeded, match=r"`make install`.*`pip install matplotlib`"):
        need_plots()
    with pytest.raises(ExtraNeeded):
        confusion_picture(np.eye(2), ["a", "b"], "svg")


def test_groups_have_different_styles() -> None:
    groups = range(28)
    assert len({(color(g), str(dashes(g))) for g in groups}) == 28
    assert len({(color(g), marker(g)) for g in range(70)}) == 70


def test_long_names_are_shortened_and_control_characters_replaced() -> None:
    assert shown("walk") == "walk"
    long = shown("a" * 30 + "b" * 30)
    assert (len(long), long[0], long[-1]) == (MAX_NAME_LENGTH, "a", "b")
    assert shown("a\nb\x1b") == "a\N{REPLACEMENT CHARACTER}b\N{REPLACEMENT CHARACTER}"
