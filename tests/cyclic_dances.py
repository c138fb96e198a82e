"""Cyclic dances: a sequence of poses that is repeated several times with small differences."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import move_joint, standing, turned_about_y
from tests.dances import SWUNG


@dataclass(frozen=True)
class CyclicDance:
    """A dance with known stops and cycles.

    positions: (frames, 13, 3) meters; rate: Hz; stops: (k,) seconds; cycles: start and end of each
    repetition of the sequence, seconds; labels: (k,) index in the sequence of the pose at each
    stop, -1 for poses outside of the sequence.
    """

    positions: FloatArray
    rate: float
    stops: FloatArray
    cycles: tuple[tuple[float, float], ...]
    labels: tuple[int, ...]


def cyclic_dance(
    seed: int,
    *,
    poses: int = 6,
    times: int = 4,
    before: int = 3,
    after: int = 3,
    tempo: float = 90.0,
    drift: float = 0.03,
    change: float = 0.15,
    noise: float = 0.005,
    rate: float = 60.0,
    dancer: int | None = None,
) -> CyclicDance:
    """`before` poses, then a sequence of `poses` poses `times` times, then `after` other poses.

    drift: standard deviation of the relative length of each beat; change: of each pose between two
    repetitions, relative to its reach; dancer: seed of drift and change. So several dancers can
    dance the sequence of the same `seed`.
    """
    choreography = np.random.default_rng(seed)
    own = np.random.default_rng([seed, seed if dancer is None else dancer])
    reaches = np.array(list(SWUNG.values()))[:, None] / np.sqrt(2)
    drawn = choreography.normal(size=(poses + before + after, len(SWUNG), 3)) * reaches
    turns = 0.4 * choreography.normal(size=poses + before + after)
    order = [
        *range(poses, poses + before), *(list(range(poses)) * times),
        *range(poses + before, poses + before + after),
    ]  # fmt: skip
    aims = drawn[order] + change * reaches * own.normal(size=(len(order), len(SWUNG), 3))
    beats = 60.0 / tempo * (1 + drift * own.normal(size=len(order)))
    stops = 0.5 + np.cumsum(beats) - beats[0]
    t = np.arange(int((stops[-1] + 0.5) * rate)) / rate
    body = standing(len(t))
    for column, role in enumerate(SWUNG):
        move_joint(body, JointRole(role), _eased(t, stops, aims[:, column]))
    body = turned_about_y(body, _eased(t, stops, turns[order][:, None])[:, 0])
    body = body + noise * own.normal(size=body.shape)
    firsts = [before + poses * k for k in range(times + 1)]
    ends = np.append(stops, stops[-1])
    return CyclicDance(
        body,
        rate,
        stops,
        tuple((float(ends[a]), float(ends[b])) for a, b in pairwise(firsts)),
        tuple(one if one < poses else -1 for one in order),
    )


def _eased(t: FloatArray, knots: FloatArray, values: FloatArray) -> FloatArray:
    """(frames, d): the values (k, d) at the knots for a tenth of a second, eased between them."""
    index = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    start, stop = knots[index] + 0.05, knots[index + 1] - 0.05
    u = np.clip((t - start) / (stop - start), 0, 1)
    ease = (u**3 * (10 - 15 * u + 6 * u * u))[:, None]
    return np.asarray(values[index] + ease * (values[index + 1] - values[index]))
