"""Dances that repeat themselves: a sequence of poses, danced several times, never quite alike."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import place, standing, turned_about_y
from tests.dances import SWUNG


@dataclass(frozen=True)
class CyclicDance:
    """positions (frames, 13, 3) metres at `rate`; stops (k,) seconds; cycles: (start, end) in
    seconds of each time that the sequence is danced; labels (k,): the pose at each stop, -1
    where it belongs to no sequence."""

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
    """`before` poses, then a sequence of `poses` danced `times` times, then `after` more.

    drift: relative change of each beat (standard deviation); change: of each pose from time
    to time, relative to its reach; dancer: seeds what is a dancer's own (drift and change),
    so that others can dance the sequence of the same seed.
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
        place(body, JointRole(role), _eased(t, stops, aims[:, column]))
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
    """(frames, d): values (k, d) at knots, held for a tenth of a second, eased between."""
    index = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    start, stop = knots[index] + 0.05, knots[index + 1] - 0.05
    u = np.clip((t - start) / (stop - start), 0, 1)
    ease = (u**3 * (10 - 15 * u + 6 * u * u))[:, None]
    return np.asarray(values[index] + ease * (values[index + 1] - values[index]))
