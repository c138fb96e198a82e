"""The measures of quality and movement: names, units, and what each says.

The order is that of the columns of the table `clip_measures`.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Definition:
    """name: of the measure, also its column. unit: of its values. text: what it measures, and the
    source. is_fault: whether large values speak against the recording."""

    name: str
    unit: str
    text: str
    is_fault: bool = False


_RANGE = "Angle that the 5 % extremes of this joint's angle enclose."
RANGED = (
    *("trunk", "neck", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow"),
    *("left_hip", "right_hip", "left_knee", "right_knee"),
)
"""The joints with a range, by part of the body: trunk, arms, legs."""

DEFINITIONS: tuple[Definition, ...] = (
    Definition(
        "foot_skate",
        "m/s",
        "Horizontal speed of an ankle in the calmest tenth of a stance (at most 3.5 cm above the "
        "floor for .1 s), the median over stances. In a good recording a foot on the floor stands "
        "for a moment.",
        is_fault=True,
    ),
    Definition(
        "ground_penetration",
        "m",
        "Depth of the lower ankle below the floor, beyond 2 cm, the mean over frames. The floor is "
        "the height at which the ankles rest most. Penetrate of Yuan et al. 2023 (PhysDiff).",
        is_fault=True,
    ),
    Definition(
        "floating",
        "m",
        "Height of the lower ankle above the floor, beyond 2 cm, the mean over frames in which the "
        "body neither falls freely nor stands on another joint. Float of Yuan et al. 2023 "
        "(PhysDiff).",
        is_fault=True,
    ),
    Definition(
        "jitter",
        "log",
        "Log dimensionless jerk of hands, feet and head, without smoothing: ln(T^3 / v^2 * "
        "integral of |jerk|^2), v the peak speed in a window of T = 1 s; the median over windows. "
        "Balasubramanian et al. 2012, with the opposite sign: more is less smooth.",
        is_fault=True,
    ),
    Definition(
        "joint_limits",
        "share",
        "Frames in which a knee or an elbow is bent beyond 160 degrees, a knee is bent forward by "
        "more than 15, or the head by more than 100 from the trunk. Ranges of the American Academy "
        "of Orthopaedic Surgeons, with a margin.",
        is_fault=True,
    ),
    Definition(
        "self_contact",
        "share",
        "Frames in which a forearm comes as close to the trunk, the head, a leg or the other "
        "forearm, or a shin to the other leg, as if they had merged: to the larger of both radii.",
    ),
    Definition(
        "airborne_time",
        "s",
        "Time in which both ankles are high above the floor, and the body "
        "falls freely: its center of mass accelerates downward by more than half of gravity.",
    ),
    Definition(
        "unsupported_time",
        "s",
        "Time outside of flights in which the center of mass is more than .35 body lengths beside "
        "the line between any two joints near the floor, or in which no joint is near the floor.",
    ),
    Definition("turn", "deg", "Sum of all turns of the body about the vertical, to both sides."),
    Definition("net_turn", "deg", "Turn from the first frame to the last, positive to the left."),
    Definition(
        "dominance",
        "-1..1",
        "Which side moves more: mean speed of the left arm and leg less that of the right, over "
        "their sum, in the body frame. 1: only the left; -1: only the right.",
    ),
    Definition(
        "cyclicity",
        "0..1",
        "Largest correlation of the poses with themselves .3 to 3 s later; 1 repeats exactly.",
    ),
    Definition("cycle_time", "s", "The time of that cycle, or of several."),
    Definition(
        "loop_gap",
        "lengths",
        "Loopability: the least difference of the poses and velocities at two times that are at "
        "least .5 s and a quarter of the clip apart, root mean square over the joints, in body "
        "lengths. The clip can be looped there. Transition cost of Kovar et al. 2002 (Motion "
        "Graphs).",
    ),
    Definition("loop_start", "s", "Where the best loop begins."),
    Definition("loop_end", "s", "Where the best loop ends."),
    Definition("start_speed", "lengths/s", "Speed of the joints in the first .2 s: 0 is a rest."),
    Definition("end_speed", "lengths/s", "Speed of the joints in the last .2 s: 0 is a rest."),
    *(Definition(f"range_{name}", "deg", _RANGE) for name in RANGED),
)
NAMES: tuple[str, ...] = tuple(one.name for one in DEFINITIONS)
