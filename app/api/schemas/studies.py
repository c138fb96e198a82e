"""The study of low-dimensional motions: pairs, votes and the tally."""

from __future__ import annotations

from datetime import datetime

from pydantic import ConfigDict, Field

from app.analysis.low_dimensional.eigen_motion import PAPER_DIMENSIONS
from app.api.schemas.base import Cursor, Fps, Id, Incoming, Limit, Outgoing
from app.services.views import studies
from app.services.views.low_dimensional import MAX_MODEL_CLIPS
from app.services.views.studies import MAX_SEQUENCES, MAX_VOTER
from app.store.studies import Choice, PairRecord

PAIRS = "/v1/studies/low-dimensional/pairs"


class NewPair(Incoming):
    """What shall be compared."""

    clip_id: Id
    dimensions: int = Field(
        PAPER_DIMENSIONS,
        ge=1,
        le=10**6,
        description="Of both versions; up to the poses of the model.",
    )
    model_clips: list[Id] = Field(
        default_factory=list,
        max_length=MAX_MODEL_CLIPS,
        description="Clips whose poses make the models; default: the clip itself.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"clip_id": "CLIP_ID", "dimensions": 3}]}
    )


class Pair(Outgoing):
    """Two versions of a clip: one drawn from keyposes, one from uniform poses. The
    answer does not say which side is which."""

    id: str
    clip_id: str
    dimensions: int
    left: str = Field(description="Path of the motion on the left.")
    original: str = Field(description="Path of the original, on the same joints.")
    right: str = Field(description="Path of the motion on the right.")
    animation: str = Field(description="Path of a picture of the three that moves.")
    votes: str = Field(description="Path to which votes are posted.")
    created_at: datetime

    @classmethod
    def of(cls, pair: PairRecord) -> Pair:
        """The pair as the API shows it: without its sides."""
        path = f"{PAIRS}/{pair.id}"
        return cls(
            id=pair.id,
            clip_id=pair.clip_id,
            dimensions=pair.dimensions,
            left=f"{path}/left",
            original=f"{path}/original",
            right=f"{path}/right",
            animation=f"{path}/animation.svg",
            votes=f"{path}/votes",
            created_at=pair.created_at,
        )


class PairList(Outgoing):
    """A page of pairs, the newest first."""

    items: list[Pair]
    next: str | None


class PairsQuery(Incoming):
    """Which page of the pairs."""

    limit: Limit = 50
    cursor: Cursor | None = None


class SideQuery(Incoming):
    """How a motion of a pair is returned."""

    fps: Fps | None = Field(
        None, description="Resampled by time; default: 30, at which it is made."
    )


class NewVote(Incoming):
    """Which version is nearer to the original."""

    choice: Choice
    voter: str | None = Field(
        None,
        min_length=1,
        max_length=MAX_VOTER,
        description="Anything that identifies a voter, such as a random number that the page "
        "keeps; one vote each on a sequence. Kept as a hash only.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"choice": "left", "voter": "f3b1c9"}]}
    )


class Vote(Outgoing):
    """A vote that was kept. The answer does not say which basis it was for: the voter may see
    more pairs."""

    id: str
    pair_id: str
    choice: Choice


class TallyQuery(Incoming):
    """Whose votes."""

    clip_id: str | None = Field(
        None, min_length=1, max_length=100, description="Of this clip's pairs only."
    )


class Tally(Outgoing):
    """Votes as in Perera's Table 2."""

    keypose: int = Field(description="How often the version drawn from keyposes was chosen.")
    uniform: int
    same: int = Field(description="How often the two looked the same.")
    share: float | None = Field(
        ge=0, le=1, description="keypose / (keypose + uniform); null without such votes."
    )
    interval: list[float] = Field(
        min_length=2, max_length=2, description="Of the share, 95 % (Wilson)."
    )
    chance: float = Field(
        ge=0,
        le=1,
        description="Probability of a share as far from one half if nobody could see a difference "
        "(exact binomial test, which assumes independent votes).",
    )


class SequenceTally(Tally):
    """The votes on one clip with one model and so many dimensions."""

    clip_id: str
    name: str
    dimensions: int

    @classmethod
    def of_sequence(cls, found: studies.SequenceTally) -> SequenceTally:
        """The row of Table 2 as the API shows it."""
        return cls(
            **dict(Tally.model_validate(found.votes)),
            clip_id=found.clip_id,
            name=found.name,
            dimensions=found.dimensions,
        )


class StudyTally(Outgoing):
    """Table 2 of this library."""

    sequences: list[SequenceTally] = Field(
        description=f"The first {MAX_SEQUENCES} by name; ask by `clip_id` for others. The other"
        " figures are of all."
    )
    total: Tally
    left_share: float | None = Field(
        ge=0, le=1, description="How often the left side was chosen; one half is fair."
    )

    @classmethod
    def of(cls, found: studies.StudyTally) -> StudyTally:
        """The table as the API shows it."""
        return cls(
            sequences=[SequenceTally.of_sequence(row) for row in found.sequences],
            total=Tally.model_validate(found.total),
            left_share=found.left_share,
        )
