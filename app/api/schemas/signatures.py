"""Signatures of persons, parameters of tasks, eigenmotions, and the weights of clips."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from app.api.schemas.base import Cursor, Incoming, Label, Limit, Outgoing
from app.api.schemas.views import plain
from app.models.signatures.coordinates import Coordinates
from app.models.signatures.eigenmotions import Eigenmotions
from app.models.signatures.parameters import Parameters
from app.numerics.arrays import FloatArray
from app.services.recognition import signatures as found
from app.services.recognition.signatures import MAX_DEVIATIONS, MAX_EIGENMOTIONS, SECONDS
from app.store.clips.filter import ClipFilter

Point = Annotated[list[float], Field(min_length=2, max_length=2)]
Labels = Annotated[list[Label], Field(max_length=100)]


class SignaturesQuery(Incoming):
    """How many eigenmotions are returned, and the weights of which clips."""

    eigenmotions: int = Field(
        8,
        ge=0,
        le=MAX_EIGENMOTIONS,
        description="Number of eigenmotions, and of weights of each clip.",
    )
    person: Labels = Field([], description="Only clips of these persons.")
    task: Labels = Field([], description="Only clips with these tasks.")
    limit: Limit = 100
    cursor: Cursor | None = None

    def as_filter(self) -> ClipFilter:
        """The filter of the store."""
        return ClipFilter(person=tuple(self.person), task=tuple(self.task))


class EigenmotionQuery(Incoming):
    """How an eigenmotion is played."""

    deviations: float = Field(
        2.0,
        ge=-MAX_DEVIATIONS,
        le=MAX_DEVIATIONS,
        description="How far from the mean motion, in standard deviations of the weight over all "
        "persons and tasks. 0 is the mean motion.",
    )
    seconds: float = Field(
        2.0,
        ge=SECONDS[0],
        le=SECONDS[1],
        description="Duration, seconds. It can be chosen, since an eigenmotion has no duration.",
    )


class NamedVector(Outgoing):
    """The parameters of a person or a task."""

    name: str
    vector: list[float] = Field(description="Its row of the mode matrix, without a unit.")
    point: Point = Field(
        description="Its place on the two principal axes of vectors times singular values, in the "
        "unit of samples."
    )


class ParameterSpace(Outgoing):
    """The parameters of all persons, or of all tasks.

    Two rows of a mode matrix are about equally far apart. To compare them, multiply each number by
    its singular value: then the distance of two persons is that of their motions in all tasks.
    """

    singular_values: list[float] = Field(
        description="How much each number of a vector changes motions."
    )
    variance_kept: float = Field(
        ge=0, le=1, description="Share of the variance that the points show."
    )
    items: list[NamedVector]

    @classmethod
    def of(cls, space: Parameters) -> ParameterSpace:
        """The parameters as the API shows them."""
        rows = zip(
            space.names, plain(space.vectors), plain(space.points(space.vectors)), strict=True
        )
        return cls(
            singular_values=plain(space.singular_values),
            variance_kept=space.kept,
            items=[NamedVector(name=name, vector=own, point=at) for name, own, at in rows],
        )


class MotionCurves(Outgoing):
    """A motion, or an eigenmotion, as curves of the channels over 32 moments."""

    curves: list[list[float]] = Field(description="(32, channels).")
    turn: float = Field(description="asinh of the net turn in radians.")
    speed: float = Field(description="Mean speed of the hips, body lengths per second.")

    @classmethod
    def of(cls, coordinates: Coordinates, sample: FloatArray) -> MotionCurves:
        """The curves of a sample."""
        parts = coordinates.parts(sample)
        return cls(curves=plain(parts.curves), turn=parts.turn, speed=parts.speed)


class Eigenmotion(Outgoing):
    """An eigenmotion: a column of J (Vasilescu 2002, eq. 3)."""

    number: int = Field(ge=1)
    name: str
    mean: float = Field(description="Mean weight over all persons and tasks.")
    deviation: float = Field(ge=0, description="Standard deviation of the weight.")
    variance: float = Field(
        ge=0, le=1, description="Its share of the variance between persons and tasks."
    )
    vector: MotionCurves = Field(description="Of length 1 over all its numbers.")

    @classmethod
    def first(
        cls, motions: Eigenmotions, coordinates: Coordinates, count: int
    ) -> list[Eigenmotion]:
        """The first eigenmotions as the API shows them."""
        return [
            cls(
                number=place + 1,
                name=f"eigenmotion {place + 1}",
                mean=float(motions.means[place]),
                deviation=float(motions.deviations[place]),
                variance=min(float(motions.shares[place]), 1.0),
                vector=MotionCurves.of(coordinates, motions.vectors[place]),
            )
            for place in range(min(count, len(motions)))
        ]


class ClipSignature(Outgoing):
    """What a single clip says about its person and its task."""

    clip_id: str
    name: str
    person: str | None
    task: str | None
    signature: list[float] | None = Field(
        description="The signature of whoever moves, computed from this clip and its task (section "
        "5). null if the model does not know the task."
    )
    person_point: Point | None = Field(description="Its place among the points of the persons.")
    action: list[float] | None = Field(
        description="The parameters of what is done, computed from this clip and its person. null "
        "if the model does not know the person."
    )
    task_point: Point | None = Field(description="Its place among the points of the tasks.")
    weights: list[float] = Field(
        description="Weights of the eigenmotions: the clip is nearly the sum of the vectors of all "
        "eigenmotions, each times its weight."
    )

    @classmethod
    def of(cls, one: found.ClipWeights, count: int) -> ClipSignature:
        """The parameters of a clip as the API shows them, with `count` weights."""
        own = one.parameters
        return cls(
            clip_id=one.clip.id,
            name=one.clip.name,
            person=one.clip.person,
            task=one.clip.task,
            signature=_list(own.signature),
            person_point=_list(one.person_point),
            action=_list(own.action),
            task_point=_list(one.task_point),
            weights=plain(own.weights[:count]),
        )


class Signatures(Outgoing):
    """A multilinear model (Vasilescu 2002): who, what, and the motions of which both are made.

    The motion of a person at a task is the core tensor times the vector of the person, the vector
    of the task, and the eigenmotions.
    """

    model_id: str
    kind: str
    version: int
    coordinates: Literal["positions", "angles"] = Field(
        description="What the curves are: positions of 13 joints in the body frame (X left, Y up, "
        "Z forward, from the hips), or joint angles."
    )
    unit: str = Field(description="Unit of the curves.")
    channels: list[str] = Field(description="Names of the curves' columns.")
    persons: ParameterSpace = Field(description="Signatures of persons: the rows of P.")
    tasks: ParameterSpace = Field(description="Parameters of actions: the rows of A.")
    mean: MotionCurves = Field(description="The mean motion of all persons and tasks.")
    eigenmotion_count: int = Field(description="Number of the model's eigenmotions.")
    eigenmotions: list[Eigenmotion] = Field(
        description="The first ones. The mean is not subtracted before the fit, so the first one "
        "is close to the mean motion."
    )
    clips: list[ClipSignature] = Field(
        description="Recorded clips of this page, sorted by name. Clips that the model cannot read "
        "are left out."
    )
    total: int = Field(description="Number of clips on all pages.")
    next: str | None = Field(description="Cursor of the next page of clips, null on the last one.")

    @classmethod
    def of(cls, view: found.Signatures, count: int) -> Signatures:
        """The signatures as the API shows them, with the first `count` eigenmotions."""
        return cls(
            model_id=view.record.id,
            kind=view.record.kind,
            version=view.record.version,
            coordinates=view.coordinates.name,
            unit=view.coordinates.unit,
            channels=list(view.coordinates.channels),
            persons=ParameterSpace.of(view.persons),
            tasks=ParameterSpace.of(view.tasks),
            mean=MotionCurves.of(view.coordinates, view.motions.mean),
            eigenmotion_count=len(view.motions),
            eigenmotions=Eigenmotion.first(view.motions, view.coordinates, count),
            clips=[ClipSignature.of(one, count) for one in view.clips.items],
            total=view.clips.total or 0,
            next=view.clips.next,
        )


def _list(values: FloatArray | None) -> list[float] | None:
    return None if values is None else plain(values)
