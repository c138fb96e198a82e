"""The unit of a file's numbers, judged from the stature of the body.

The stature is estimated from shanks, thighs and arms by the proportions of Drillis and Contini
(1966; Winter, "Biomechanics and motor control of human movement", fig. 4.1): shank .246, thigh
.245, upper arm .186, forearm .146 of the stature. Medians over frames and segments are used, so
that a bad frame or an unusual bone does not matter.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray

METERS_PER_UNIT: dict[str, float] = {
    "m": 1.0,
    "cm": 0.01,
    "mm": 0.001,
    "in": 0.0254,
    "ft": 0.3048,
    "dm": 0.1,
    "cmu": 0.056444,
}
"""The unit names that a client may use. "cmu" is the unit of CMU's ASF/AMC files (1 / .45 inch)."""
SCALES = (1e-6, 1e3)
"""Meters per unit: the smallest and the largest value that a client may give."""
TYPICAL_STATURE = 1.7
"""Meters."""
MIN_STATURE = 1e-6
"""In any unit. A body with a smaller stature has no size."""
USUAL_STATURES = (1.35, 2.15)
"""Meters. Outside this range, a caution says that the unit is a guess."""
CHILD_STATURES = (0.8, 1.35)
"""Meters. A small person in one unit goes before a giant in another one."""
_OF_CHILDREN = ("m", "cm", "mm", "in", "ft", "cmu", "dm")
POWERS_OF_TEN = (1e-4, 10.0, 1e-5, 100.0)
"""Meters per unit of files that were scaled once too often, by 10 or 100."""
MAX_GUESSED_FACTOR = 1.6
"""If no unit gives a stature within this factor of the typical one, the body is scaled to it."""
MAX_MEASURED_FRAMES = 1_000
"""About the number of frames, evenly spaced, in which bones are measured."""
MAX_DECLARED_FACTOR = 2.5
"""The unit of a file is accepted if the stature is within this factor of the typical one."""

_R = JointRole
_SEGMENTS: tuple[tuple[JointRole, JointRole, float], ...] = (
    (_R.LEFT_KNEE, _R.LEFT_FOOT, 0.246),
    (_R.RIGHT_KNEE, _R.RIGHT_FOOT, 0.246),
    (_R.LEFT_UPPER_LEG, _R.LEFT_KNEE, 0.245),
    (_R.RIGHT_UPPER_LEG, _R.RIGHT_KNEE, 0.245),
    (_R.LEFT_SHOULDER, _R.LEFT_ELBOW, 0.186),
    (_R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, 0.186),
    (_R.LEFT_ELBOW, _R.LEFT_HAND, 0.146),
    (_R.RIGHT_ELBOW, _R.RIGHT_HAND, 0.146),
    (_R.HIPS, _R.NECK, 0.29),
    (_R.HIPS, _R.LEFT_KNEE, 0.26),
    (_R.HIPS, _R.RIGHT_KNEE, 0.26),
)
"""The ends of each segment, and its length as a share of the stature."""


@dataclass(frozen=True, slots=True)
class Unit:
    """The meters per unit, and a caution if they are a guess."""

    metres_per_unit: float
    cautions: tuple[Caution, ...] = ()


def stature(positions: FloatArray, roles: Mapping[JointRole, int]) -> float:
    """The stature of the person, in the unit of `positions` (frames, joints, 3); 0 if unknown.

    roles: the joint of each role.
    """
    known = [one for one in _SEGMENTS if one[0] in roles and one[1] in roles]
    if not known:
        return 0.0
    starts, ends = [roles[start] for start, _, _ in known], [roles[end] for _, end, _ in known]
    some = positions[:: max(1, len(positions) // MAX_MEASURED_FRAMES)]
    bones = np.linalg.norm(some[:, ends] - some[:, starts], axis=-1)
    estimates = np.median(bones, axis=0) / [share for *_, share in known]
    estimates = estimates[estimates > 0]
    return float(np.median(estimates)) if len(estimates) else 0.0


def judge_unit(positions: FloatArray, roles: Mapping[JointRole, int]) -> Unit:
    """The unit by which the stature is nearest to TYPICAL_STATURE, if it is a usual one.

    positions: (frames, joints, 3) in the unit of the file. roles: the joint of each role. Else it
    is a power of ten of a meter that gives a usual stature, or a unit that gives that of a child,
    metric ones first, or the nearest unit. If none fits, the body is scaled to TYPICAL_STATURE. A
    caution says that the unit is a guess.
    """
    height = stature(positions, roles)
    if height < MIN_STATURE:
        detail = "the body has no size, so its unit cannot be guessed; meters are used"
        return Unit(1.0, (Caution("unit_guessed", detail),))
    # Logarithms, because half and twice the stature are equally unusual.
    away = {name: _away(height * scale) for name, scale in METERS_PER_UNIT.items()}
    nearest = min(away, key=lambda name: away[name])
    if _is_within(USUAL_STATURES, height * METERS_PER_UNIT[nearest]):
        return Unit(METERS_PER_UNIT[nearest])
    power = next((p for p in POWERS_OF_TEN if _is_within(USUAL_STATURES, height * p)), None)
    if power is not None:
        tall = f"{height * power:.2f} m tall"
        detail = f"no known unit fits; with {power:g} m per unit the person would be {tall}"
        return Unit(power, (Caution("unit_guessed", detail, likely=power),))
    child = next(
        (n for n in _OF_CHILDREN if _is_within(CHILD_STATURES, height * METERS_PER_UNIT[n])), None
    )
    if child is None and away[nearest] > np.log(MAX_GUESSED_FACTOR):
        best = TYPICAL_STATURE / height
        detail = f"no known unit fits; scaled so that the person is {TYPICAL_STATURE} m tall"
        return Unit(best, (Caution("unit_guessed", detail, likely=best),))
    return _doubtful_unit(height, child or nearest, nearest)


def _doubtful_unit(height: float, name: str, nearest: str) -> Unit:
    """The unit `name`, with a caution that also names the unit nearest to a usual stature.

    height: the stature in the unit of the file.
    """
    best = METERS_PER_UNIT[name]
    detail = f"in {name} the person would be {height * best:.2f} m tall"
    if nearest != name:
        detail += f"; in {nearest}, {height * METERS_PER_UNIT[nearest]:.2f} m"
    return Unit(best, (Caution("unit_guessed", detail, likely=best),))


def _away(stature_in_meters: float) -> float:
    return abs(float(np.log(stature_in_meters / TYPICAL_STATURE)))


def _is_within(limits: tuple[float, float], value: float) -> bool:
    return limits[0] <= value <= limits[1]


def confirm_unit(declared: float, positions: FloatArray, roles: Mapping[JointRole, int]) -> Unit:
    """The unit that a file declares, or else the judged unit.

    declared: meters per unit. positions: (frames, joints, 3) in the unit of the file. roles: the
    joint of each role. The judged unit is used if the declared one gives an impossible stature.
    Exporters often write a scale that does not fit their numbers.
    """
    height = stature(positions, roles) * declared
    if height < MIN_STATURE or abs(np.log(height / TYPICAL_STATURE)) <= np.log(MAX_DECLARED_FACTOR):
        return Unit(declared)
    judged = judge_unit(positions, roles)
    detail = (
        f"by the file's own unit the person would be {height:.3g} m tall; "
        f"{judged.metres_per_unit:g} m are used instead of {declared:g} m"
    )
    return Unit(
        judged.metres_per_unit,
        (Caution("unit_suspect", detail, likely=judged.metres_per_unit), *judged.cautions),
    )
