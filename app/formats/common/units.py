"""The units of files by their names: `mm`, `Millimeters`, `metres`, ..."""

from __future__ import annotations

from app.motion.canonical.units import METERS_PER_UNIT

_WORDS = {"millimeter": "mm", "centimeter": "cm", "meter": "m", "inch": "in", "inche": "in",
          "foot": "ft", "feet": "ft", "decimeter": "dm"}  # fmt: skip


def named_unit(name: str) -> float | None:
    """The meters per unit of a unit's name; None for an unknown name."""
    plain = name.strip().strip("()[]").lower()
    spelled = plain.replace("metre", "meter").rstrip("s")
    return METERS_PER_UNIT.get(_WORDS.get(spelled, plain))
