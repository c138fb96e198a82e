"""The names, signs and definitions of the joint angles. All are in degrees."""

from __future__ import annotations

from dataclasses import dataclass

SIDES = ("left", "right")


@dataclass(frozen=True, slots=True)
class Angle:
    """One angle.

    name: ends with its unit. definition: what it measures and when it is positive.
    """

    name: str
    definition: str


_MIDDLE = (
    Angle(
        "pelvis_anterior_tilt_deg",
        "pelvis in the laboratory; positive: the front of the pelvis goes down",
    ),
    Angle("pelvis_obliquity_deg", "pelvis in the laboratory; positive: the left side is higher"),
    Angle(
        "pelvis_rotation_deg",
        "pelvis in the laboratory, about the vertical, unwrapped; 0 faces +Z of the positions; "
        "positive: turned to the left (counterclockwise from above)",
    ),
    Angle("thorax_anterior_tilt_deg", "thorax in the laboratory; positive: leans forward"),
    Angle("thorax_obliquity_deg", "thorax in the laboratory; positive: the left side is higher"),
    Angle("thorax_rotation_deg", "thorax in the laboratory, as pelvis_rotation_deg"),
    Angle("trunk_flexion_deg", "thorax relative to the pelvis; positive: bends forward"),
    Angle(
        "trunk_left_lateral_flexion_deg",
        "thorax relative to the pelvis; positive: bends to the left",
    ),
    Angle("trunk_left_rotation_deg", "thorax relative to the pelvis; positive: turns to the left"),
)

_SIDED = (
    Angle("hip_flexion_deg", "thigh relative to the pelvis; positive: the knee goes forward"),
    Angle("hip_adduction_deg", "positive: the knee goes toward the other leg"),
    Angle("hip_internal_rotation_deg", "positive: the front of the thigh turns inward"),
    Angle("knee_flexion_deg", "shank relative to the thigh; 0: straight; positive: the knee bends"),
    Angle("knee_adduction_deg", "positive: varus, the foot goes inward"),
    Angle("knee_internal_rotation_deg", "positive: the front of the shank turns inward"),
    Angle("ankle_dorsiflexion_deg", "foot relative to the shank; positive: the toes go up"),
    Angle("ankle_inversion_deg", "positive: the sole turns inward"),
    Angle("ankle_internal_rotation_deg", "positive: the toes turn inward"),
    Angle(
        "shoulder_flexion_deg",
        "upper arm relative to the thorax; 0: it hangs; positive: it goes forward",
    ),
    Angle("shoulder_adduction_deg", "negative: the arm goes away from the body (abduction)"),
    Angle(
        "shoulder_plane_of_elevation_deg",
        "the direction in which the arm is raised; 0: to the side; 90: forward; noise while the "
        "arm hangs",
    ),
    Angle("shoulder_elevation_deg", "0: the arm hangs; 90: horizontal; 180: overhead"),
    Angle(
        "shoulder_internal_rotation_deg",
        "about the long axis of the upper arm, the third angle of the Y-X-Y sequence, "
        "plus the first one; positive: the front of the upper arm turns inward",
    ),
    Angle("elbow_flexion_deg", "forearm relative to the upper arm; 0: straight; positive: bent"),
)

ANGLES: tuple[Angle, ...] = (
    *_MIDDLE,
    *(Angle(f"{side}_{one.name}", one.definition) for side in SIDES for one in _SIDED),
)
"""All angles, in the order of the columns."""

ANGLE_NAMES: tuple[str, ...] = tuple(angle.name for angle in ANGLES)


def explained() -> str:
    """The definitions as lines of Markdown; an angle of both sides stands once."""
    sided = [Angle(f"left_/right_{one.name}", one.definition) for one in _SIDED]
    return "\n".join(f"- `{one.name}`: {one.definition}" for one in (*_MIDDLE, *sided))
