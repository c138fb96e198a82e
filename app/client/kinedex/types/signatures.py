"""Answers: signatures. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinedex.records import Array, Record


@dataclass(frozen=True, slots=True)
class ClipSignature(Record):
    """What a single clip says about its person and its task.

    signature: The signature of whoever moves, computed from this clip and its task (section 5).
    null if the model does not know the task.
    person_point: Its place among the points of the persons.
    action: The parameters of what is done, computed from this clip and its person. null if the
    model does not know the person.
    task_point: Its place among the points of the tasks.
    weights: Weights of the eigenmotions: the clip is nearly the sum of the vectors of all
    eigenmotions, each times its weight.
    """

    clip_id: str
    name: str
    person: str | None
    task: str | None
    signature: list[float] | None
    person_point: list[float] | None
    action: list[float] | None
    task_point: list[float] | None
    weights: list[float]


@dataclass(frozen=True, slots=True, eq=False)
class MotionCurves(Record):
    """A motion, or an eigenmotion, as curves of the channels over 32 moments.

    curves: (32, channels).
    turn: asinh of the net turn in radians.
    speed: Mean speed of the hips, body lengths per second.
    """

    curves: Array
    turn: float
    speed: float


@dataclass(frozen=True, slots=True)
class Eigenmotion(Record):
    """An eigenmotion: a column of J (Vasilescu 2002, eq. 3).

    mean: Mean weight over all persons and tasks.
    deviation: Standard deviation of the weight.
    variance: Its share of the variance between persons and tasks.
    vector: Of length 1 over all its numbers.
    """

    number: int
    name: str
    mean: float
    deviation: float
    variance: float
    vector: MotionCurves


@dataclass(frozen=True, slots=True)
class NamedVector(Record):
    """The parameters of a person or a task.

    vector: Its row of the mode matrix, without a unit.
    point: Its place on the two principal axes of vectors times singular values, in the unit of
    samples.
    """

    name: str
    vector: list[float]
    point: list[float]


@dataclass(frozen=True, slots=True)
class ParameterSpace(Record):
    """The parameters of all persons, or of all tasks.

    Two rows of a mode matrix are about equally far apart. To compare them, multiply each number by
    its singular value: then the distance of two persons is that of their motions in all tasks.

    singular_values: How much each number of a vector changes motions.
    variance_kept: Share of the variance that the points show.
    """

    singular_values: list[float]
    variance_kept: float
    items: list[NamedVector]


@dataclass(frozen=True, slots=True)
class Signatures(Record):
    """A multilinear model (Vasilescu 2002): who, what, and the motions of which both are made.

    The motion of a person at a task is the core tensor times the vector of the person, the vector
    of the task, and the eigenmotions.

    coordinates: What the curves are: positions of 13 joints in the body frame (X left, Y up, Z
    forward, from the hips), or joint angles.
    unit: Unit of the curves.
    channels: Names of the curves' columns.
    persons: Signatures of persons: the rows of P.
    tasks: Parameters of actions: the rows of A.
    mean: The mean motion of all persons and tasks.
    eigenmotion_count: Number of the model's eigenmotions.
    eigenmotions: The first ones. The mean is not subtracted before the fit, so the first one is
    close to the mean motion.
    clips: Recorded clips of this page, sorted by name. Clips that the model cannot read are
    left out.
    total: Number of clips on all pages.
    next: Cursor of the next page of clips, null on the last one.
    """

    model_id: str
    kind: str
    version: int
    coordinates: Literal["positions", "angles"]
    unit: str
    channels: list[str]
    persons: ParameterSpace
    tasks: ParameterSpace
    mean: MotionCurves
    eigenmotion_count: int
    eigenmotions: list[Eigenmotion]
    clips: list[ClipSignature]
    total: int
    next: str | None
