"""Finds the place on the body that the label of a marker names, in common marker sets.

The marker sets are Vicon plug-in-gait (`LKNE`, `Bob:LASI`), CMU's own (`LFWT`), Helen Hayes as
Cortex names it (`L.Knee.Medial`, `V.Sacral`), the ISB's anatomical landmarks (`LFLE`), OptiTrack's
baseline (`WaistLFront`), Xsens MVN (`pLeftASI`), CAST (`LLEPI`, `LLFC`), Rizzoli (`LLE`, `LLM`),
Qualisys (`HeadL`, `SpineTop`), OpenCap (`r_mknee_study`). Case and separators do not matter, and
the side may come last (`ASISL`). Sources: Vicon's plug-in gait reference
guide; Kadaba et al. 1990 (Helen Hayes); Leardini et al. 2007 (ISB names).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache

from app.motion.roles.joint_names import side_and_word

# Places on both sides, and their labels; ? is L or R.
_SIDED: dict[str, tuple[str, ...]] = {
    "ASI": ("?ASI", "?ASIS", "?IAS", "?FWT", "WAIST?FRONT", "?WAISTFRONT", "?SIAS"),
    "PSI": ("?PSI", "?PSIS", "?IPS", "?BWT", "WAIST?BACK", "?WAISTBACK", "?SIPS"),
    "HJC": ("?HJC",),
    "GTR": ("?GTR", "?TRO", "?GTRO", "?TROCH", "?TROCHANTER", "?GT", "?GRT", "?TRC"),
    "KJC": ("?KJC",),
    "KNE": (
        "?KNE", "?KNEE", "?KNEELAT", "?KNEELATERAL", "?LATKNEE", "?KNEEOUT", "?FLE", "?LEK",
        "?LEPI", "?LFC", "?KNEL", "?LE", "?LKNE", "?KNELAT", "?LKNEE", "?KNEELATEPICONDYLE",
        "?LATFEMEPI", "?KL", "?KNEE1", "?KNJNTLN",
    ),
    "KNM": (
        "?KNM", "?MKNE", "?KNEM", "?KNI", "?KNEEMED", "?KNEEMEDIAL", "?MEDKNEE", "?KNEEIN", "?FME",
        "?MEK", "?MEPI", "?MFC", "?ME", "?MKNEE", "?KNEMED", "?KNEEMEDEPICONDYLE", "?MEDFEMEPI",
        "?KM",
    ),
    "AJC": ("?AJC",),
    "ANK": (
        "?ANK", "?ANKLE", "?ANKLELAT", "?ANKLELATERAL", "?LATANKLE", "?ANKLEOUT", "?FAL", "?LMAL",
        "?ANKL", "?LM", "?LATMALLEOLUS", "?LMALL", "?LANK", "?LANKLE", "?AL", "?MALL", "?MALLEOLUS",
        "?LMA",
    ),
    "ANM": (
        "?ANM", "?MANK", "?ANKM", "?MED", "?ANKLEMED", "?ANKLEMEDIAL", "?MEDANKLE", "?ANKLEIN",
        "?TAM", "?MMAL", "?MM", "?MEDMALLEOLUS", "?MMALL", "?MANKLE", "?AM", "?MMA",
    ),
    "HEE": ("?HEE", "?HEEL", "?CAL", "?CALC", "?HEELBACK", "?FCC"),
    "MFS": ("?MIDFOOTSUP",),
    "TOE": (
        "?TOE", "?TOES", "?TOETIP", "?MT2", "?SMH", "?SM", "?FOREFOOT2", "?2MH", "?MTH2", "?TOE2",
    ),
    "MT1": ("?MT1", "?FMH", "?TOEIN", "?FM", "?FOREFOOTIN", "?1MH", "?MTH1"),
    "MT5": (
        "?MT5", "?VMH", "?TOEOUT", "?VM", "?FOREFOOTOUT", "?5META", "?5MH", "?MTH5", "?MET", "?FL",
    ),
    "SJC": ("?SJC",),
    "SHO": (
        "?SHO", "?SHOULDER", "?ACR", "?ACROMION", "?SAE", "?SHOULDERTOP", "?SHOTOP", "?SHLD", "?SH",
        "?AC", "?ACROMIO", "?ACROMIUM", "?SHOULD",
    ),
    "EJC": ("?EJC",),
    "ELB": (
        "?ELB", "?ELBOW", "?ELBLAT", "?ELBOWLAT", "?ELBOWLATERAL", "?ELBOWOUT", "?HLE", "?EL",
        "?LELBOW", "?ELBL", "?ARMLATEPICONDYLE", "?LHE", "?ELBLATERAL", "?LEL",
    ),
    "ELM": (
        "?ELM", "?MELB", "?ELBM", "?ELBMED", "?ELBOWMED", "?ELBOWMEDIAL", "?ELBOWIN", "?HME",
        "?IEL", "?MELBOW", "?ARMMEDEPICONDYLE", "?MHE", "?MEL",
    ),
    "WJC": ("?WJC",),
    "WRA": (
        "?WRA", "?RSP", "?WRISTIN", "?WRISTRAD", "?LWRIST", "?RADIALSTYLOID", "?WRISTLAT", "?RS",
        "?STYLR",
    ),
    "WRB": (
        "?WRB", "?USP", "?WRISTOUT", "?WRISTULN", "?MWRIST", "?ULNARSTYLOID", "?WRISTMED", "?US",
        "?STYLU",
    ),
    "WRI": ("?WRI", "?WRIST", "?WRT", "?WR"),
    "FIN": ("?FIN", "?FINGER", "?HANDOUT", "?HAND"),
    "FHD": ("?FHD", "?FHEAD", "?HEADFRONT", "?HEAD", "?AURICULARIS", "?TRAGUS"),
    "BHD": ("?BHD", "?BHEAD", "?HEADBACK"),
}  # fmt: skip
_MIDDLE: dict[str, tuple[str, ...]] = {
    "SACR": (
        "SACR",
        "SACRUM",
        "VSACRAL",
        "SACRAL",
        "MBWT",
        "S1",
        "SAC",
        "VSACRUM",
        "SACRO",
    ),
    "C7": (
        "C7",
        "CV7",
        "BACKTOP",
        "C7SPINALPROCESS",
        "SPINETOP",
    ),
    "NECK": ("NECK",),
    "T10": (
        "T10",
        "TV10",
        "TV8",
        "T8",
        "T8SPINALPROCESS",
        "TH10",
        "SPINETHORACIC10",
    ),
    "CLAV": (
        "CLAV",
        "CLAVICLE",
        "SJN",
        "JN",
        "IJ",
        "SUPRASTERNALE",
        "MANUBRIUM",
        "JUGULAR",
    ),
    "STRN": (
        "STRN",
        "STERN",
        "STERNUM",
        "SXS",
        "XIPHOID",
        "PX",
        "XIPH",
        "XP",
    ),
    "TOPHD": (
        "TOPHEAD",
        "HEADTOP",
        "ARIEL",
        "TOPOFHEAD",
        "VERTEX",
    ),
    "FRONTHD": ("FRONTHEAD", "HEADFRONT"),
    "REARHD": ("REARHEAD", "HEADREAR", "HEADBACK", "BACKHEAD"),
}
_PLACES = {alias: place for place, aliases in _MIDDLE.items() for alias in aliases} | {
    alias.replace("?", side): side + place
    for place, aliases in _SIDED.items()
    for alias in aliases
    for side in "LR"
}
_WITHOUT_SIDE = ("HEEL",)
"""Words that end with the letter of a side and have none."""
_UPPER_ARMS = ("arm", "upperarm", "uparm", "armupper", "humerus", "uar")
"""Words for a joint at the upper end of the upper arm."""
_SHOULDERS = ("shoulder", "sho")
_XSENS = re.compile(r"^p(?=[A-Z])")
"""The letter with which Xsens begins the labels of points on the skin."""
_UNLABELED = re.compile(r"(|\*\d*|U_?\d+|UNLABELL?ED.*|M\d{3,}|UN-?NAMED.*)", re.IGNORECASE)
_NO_MARKER = re.compile(r".*(Angles?|Forces?|Moments?|Powers?|GRF)$", re.IGNORECASE)
"""Labels of results of gait models, which are stored as points but are not markers."""


def subject_and_label(label: str) -> tuple[str, str]:
    """The subject and the rest of a label: ("Bob", "LKNE") for `Bob:LKNE`; "" is for no subject."""
    subject, _, name = label.strip().rpartition(":")
    return subject.strip(), name.strip()


def is_marker(label: str) -> bool:
    """Whether a label without its subject names a marker. `*12` and `LKneeAngles` do not."""
    return not (_UNLABELED.fullmatch(label) or _NO_MARKER.fullmatch(label))


@lru_cache(maxsize=4096)
def place_on_body(label: str) -> str | None:
    """The place on the body, for example "LKNE" or "C7"; None if no marker set has the label."""
    key = re.sub(r"[\W_]", "", _XSENS.sub("", label)).upper().removesuffix("STUDY")
    key = re.sub(r"^(LEFT|RIGHT)", lambda side: side.group()[0], key)
    if key not in _PLACES and key.endswith(("L", "R")) and key not in _WITHOUT_SIDE:
        key = key[-1] + key[:-1]
    return _PLACES.get(key)


def markers_by_place(labels: Sequence[str]) -> dict[str, int]:
    """The first marker at each place; labels: (markers,) without their subjects.

    In a set of joints, `LeftShoulder` is the collar bone if there is also a `LeftArm`, and no
    marker on the shoulder.
    """
    keys = [side_and_word(label) for label in labels]
    with_arm = {side for side, word in keys if word in _UPPER_ARMS}
    found: dict[str, int] = {}
    for marker, (label, (side, word)) in enumerate(zip(labels, keys, strict=True)):
        place = place_on_body(label)
        if place is not None and not (word in _SHOULDERS and side in with_arm):
            found.setdefault(place, marker)
    return found
