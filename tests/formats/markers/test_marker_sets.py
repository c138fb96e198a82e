"""Markers of many marker sets give the same person."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.roles.marker_names import place_on_body
from tests.formats.c3d.files import c3d, marker_person, stacked
from tests.people import ROLES

TRACKS, TRUTH = marker_person()
XSENS = {
    "ASI": "?ASI", "PSI": "?SIPS", "SHO": "?Acromion", "ELB": "?ArmLatEpicondyle",
    "ELM": "?ArmMedEpicondyle", "WRA": "?RadialStyloid", "WRB": "?UlnarStyloid",
    "KNE": "?KneeLatEpicondyle", "KNM": "?KneeMedEpicondyle", "ANK": "?LatMalleolus",
    "ANM": "?MedMalleolus", "TOE": "?Toe", "C7": "pC7SpinalProcess", "STRN": "pPX",
    "T10": "pT8SpinalProcess", "CLAV": "pIJ",
}  # fmt: skip
CAST = {
    "ASI": "?SIAS", "PSI": "?SIPS", "SHO": "?SH", "ELB": "?EL", "KNE": "?LEPI", "KNM": "?MEPI",
    "ANK": "?LMAL", "ANM": "?MMAL", "STRN": "XIPH", "CLAV": "IJ",
}  # fmt: skip
CONDYLES = {"KNE": "?LFC", "KNM": "?MFC", "ANK": "?ANKL", "WRA": "?WR"}
LATERAL = {"KNE": "?KNEL", "KNM": "?KNEM", "ANK": "?LM", "ANM": "?MM", "SHO": "?AC"}
RIZZOLI = {"KNE": "?LE", "KNM": "?ME", "ANK": "?LM", "ANM": "?MM", "TOE": "?SM"}
OPENCAP = {
    "ASI": "?.ASIS_study", "PSI": "?.PSIS_study", "KNE": "?_knee_study", "KNM": "?_mknee_study",
    "ANK": "?_ankle_study", "ANM": "?_mankle_study", "TOE": "?_toe_study",
    "SHO": "?_shoulder_study", "ELB": "?_lelbow_study", "ELM": "?_melbow_study",
    "WRA": "?_lwrist_study", "WRB": "?_mwrist_study", "C7": "C7_study",
}  # fmt: skip
SIDE_LAST = {"ASI": "ASIS?", "PSI": "PSIS?", "KNE": "Knee?", "SHO": "Acr?", "FHD": "HeadFront?"}
SETS: dict[str, tuple[Mapping[str, str], str, str]] = {
    "Xsens": (XSENS, "pLeft", "pRight"),
    "CAST": (CAST, "L", "R"),
    "condyles": (CONDYLES, "L", "R"),
    "lateral": (LATERAL, "L", "R"),
    "Rizzoli": (RIZZOLI, "L", "R"),
    "OpenCap": (OPENCAP, "L", "r"),
    "side last": (SIDE_LAST, "L", "R"),
}


def renamed(label: str, names: Mapping[str, str], left: str, right: str) -> str:
    if label in names:
        return names[label]
    side, place = label[0], label[1:]
    if place not in names:
        return label
    return names[place].replace("?", left if side == "L" else right)


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("prefix", ["", "Ada:", "Ada_"])
def test_each_marker_set_gives_the_same_person(name: str, prefix: str) -> None:
    markers, labels = stacked(TRACKS)
    changed = [prefix + renamed(label, *SETS[name]) for label in labels]
    assert changed != labels
    motion = canonicalize(read_recording(c3d(markers, changed)))
    assert motion.missing_roles == ()
    assert motion.cautions == ()
    truth = TRUTH[:, [ROLES.index(role) for role in SUN_ROLES]]
    apart = np.linalg.norm(motion.role_positions() - truth, axis=-1).max(axis=0)
    assert apart.max() < 0.06


@pytest.mark.parametrize("label", ["LTHI", "LTIB", "LUPA", "HEEL", "T4", "BALL", "plate"])
def test_other_labels_are_at_no_place(label: str) -> None:
    assert place_on_body(label) is None
