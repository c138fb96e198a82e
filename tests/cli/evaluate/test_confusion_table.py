"""A confusion matrix as text: complete if it fits 100 columns, else its largest confusions."""

from __future__ import annotations

import numpy as np
import pytest

from app.cli.evaluate.confusion_table import MAX_PAIRS, print_confusion
from app.cli.output import MAX_WIDTH
from app.numerics.arrays import FloatArray


def _mostly_right(count: int) -> FloatArray:
    shares = np.random.default_rng(count).random((count, count)) + 20 * np.eye(count)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))


def test_a_small_matrix_is_printed_completely(capsys: pytest.CaptureFixture[str]) -> None:
    print_confusion(["kick", "walk"], np.array([[0.75, 0.25], [0.0, 1.0]]))
    assert capsys.readouterr().out.splitlines() == [
        "          1   2",
        " 1 kick  75  25",
        " 2 walk   . 100",
    ]


@pytest.mark.parametrize("count", [18, 19, 41, 120])
@pytest.mark.parametrize("length", [4, 200])
def test_no_line_is_wider_than_a_hundred_columns(
    capsys: pytest.CaptureFixture[str], count: int, length: int
) -> None:
    classes = [f"{number:x<{length}}" for number in range(count)]
    print_confusion(classes, _mostly_right(count))
    assert max(map(len, capsys.readouterr().out.splitlines())) <= MAX_WIDTH


def test_for_many_classes_the_largest_confusions_are_printed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    count = 41
    shares = np.eye(count)
    for true in range(40):  # class n is taken for the next one in n per cent of the cases
        shares[true, [true, true + 1]] = 1 - true / 100, true / 100
    print_confusion([f"c{number}" for number in range(count)], shares)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[1:3]] == [
        ["c39", "c40", "39", "61"],
        ["c38", "c39", "38", "62"],
    ]
    assert len(lines[1 : lines.index("")]) == MAX_PAIRS
    assert lines[-1].startswith("41 classes, the 25 largest of 39 confusions; --json")


def test_many_classes_without_confusion(capsys: pytest.CaptureFixture[str]) -> None:
    print_confusion([f"c{number}" for number in range(41)], np.eye(41))
    assert capsys.readouterr().out.startswith("41 classes, no confusion;")
