"""Labels of markers in the common marker sets."""

from __future__ import annotations

import pytest

from app.motion.roles.marker_names import (
    is_marker,
    markers_by_place,
    place_on_body,
    subject_and_label,
)


@pytest.mark.parametrize(
    ("label", "place"),
    [
        ("LKNE", "LKNE"), ("rkne", "RKNE"), ("L.Knee", "LKNE"), ("R.Knee.Medial", "RKNM"),
        ("Left Knee", "LKNE"), ("LFWT", "LASI"), ("RBWT", "RPSI"), ("L.ASIS", "LASI"),
        ("V.Sacral", "SACR"), ("RTAM", "RANM"), ("WaistLFront", "LASI"), ("WaistRBack", "RPSI"),
        ("LKneeOut", "LKNE"), ("RShoulderTop", "RSHO"), ("C7", "C7"), ("CV7", "C7"),
        ("Top.Head", "TOPHD"), ("LFHD", "LFHD"), ("RIEL", "RELM"), ("LHJC", "LHJC"),
        ("r mall", "RANK"), ("l met", "LMT5"), ("r should", "RSHO"), ("l knee 1", "LKNE"),
        ("RKM", "RKNM"), ("LAL", "LANK"), ("RAM", "RANM"), ("L.Acromium", "LSHO"),
        ("RLMA", "RANK"), ("LMMA", "LANM"), ("r_knjntln", "RKNE"), ("LTRO", "LGTR"),
        ("LLEL", "LELB"), ("RMEL", "RELM"), ("L.Heel", "LHEE"),
        ("RCAL", "RHEE"), ("L.Midfoot.Sup", "LMFS"),
        ("LTHI", None), ("", None), ("L", None), ("LEFT", None), ("\N{KELVIN SIGN}", None),
    ],
)  # fmt: skip
def test_the_place_of_each_label(label: str, place: str | None) -> None:
    assert place_on_body(label) == place


def test_the_subject_of_a_label() -> None:
    assert subject_and_label("Bob:LKNE") == ("Bob", "LKNE")
    assert subject_and_label(" LKNE ") == ("", "LKNE")
    assert subject_and_label("Lab:Bob: LKNE") == ("Lab:Bob", "LKNE")


def test_labels_that_are_not_markers() -> None:
    for label in ("", "*12", "*", "U12", "Unlabeled 7", "LKneeAngles", "RGroundReactionForce"):
        assert not is_marker(label), label
    for label in ("LKNE", "C7", "M1", "Ulna", "Forehead"):
        assert is_marker(label), label


def test_a_shoulder_beside_an_upper_arm_is_a_collar_bone() -> None:
    assert markers_by_place(["LSHO", "LUAR", "RSHO"]) == {"RSHO": 2}


def test_the_first_marker_of_a_place_is_used() -> None:
    assert markers_by_place(["LTHI", "LASI", "L.ASIS", "C7"]) == {"LASI": 1, "C7": 3}
