"""Labels of markers: plain, short, and different from each other."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from app.formats.common.marker_labels import MAX_LABEL_LENGTH, marker_labels


def test_names_keep_what_labels_may_have() -> None:
    names = ["Hips", "mixamorig:LeftLeg", "left foot", "hips", "", "日本", "Hips_2"]
    assert marker_labels(names) == [
        "Hips", "mixamorig:LeftLeg", "left_foot", "hips_2", "joint", "joint_2", "Hips_2_2",
    ]  # fmt: skip


@given(st.lists(st.text(max_size=80), max_size=20))
def test_labels_are_plain_and_unique(names: list[str]) -> None:
    labels = marker_labels(names)
    assert len({label.lower() for label in labels}) == len(names)
    for label in labels:
        assert 0 < len(label) <= MAX_LABEL_LENGTH
        assert label.isascii()
        assert not any(char.isspace() for char in label)
