"""The study of low-dimensional motions: pairs, votes and the tally."""

from __future__ import annotations

from datetime import datetime

from pydantic import ConfigDict, Field

from app.analysis.low_dimensional.eigen_motion import PAPER_DIMENSIONS
from app.api.schemas.base import Cursor, Fps, Id, Incoming, Limit, Outgoing, Paged
from app.services.views import studies
from app.services.views.low_dimensional import MAX_MODEL_CLIPS
from app.services.views.studies import MAX_SEQUENCES, MAX_VOTER
from app.store.studies import Choice, PairRecord

PAIRS = "/v1/studies/low-dimensional/pairs"


class NewPair(Incoming):
    """The clip to compare, and its number of dimensions."""

    clip_id: Id
    dimensions: int = Field(
        PAPER_DIMENSIONS,
        ge=1,
        le=10**6,
        description="Dimensions of both versions, up to the number of poses of the model.",
    )
    model_clips: list[Id] = Field(
        default_factory=list,
        max_length=MAX_MODEL_CLIPS,
        description="Clips with the poses of the models. Default: the clip itself.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"clip_id": "CLIP_ID", "dimensions": 3}]}
    )


class Pair(Outgoing):
    """Two low-dimensional versions of a clip, one from keyposes and one from uniform poses.

    The answer does not say which version is on which side.
    """

    id: str
    clip_id: str
    dimensions: int
    left: str = Field(description="Path of the motion on the left.")
    original: str = Field(description="Path of the original, on the same joints.")
    right: str = Field(description="Path of the motion on the right.")
    animation: str = Field(description="Path of an animated picture of all three motions.")
    votes: str = Field(description="Path for POST of a vote.")
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


class PairList(Paged):
    """A page of pairs, the newest first."""

    items: list[Pair]


class PairsQuery(Incoming):
    """A page of the pairs."""

    limit: Limit = 50
    cursor: Cursor | None = None


class SideQuery(Incoming):
    """Frame rate of a motion of a pair."""

    fps: Fps | None = Field(
        None, description="The motion is resampled to this rate. Default: 30, its own rate."
    )


class NewVote(Incoming):
    """A vote: the version that is nearer to the original."""

    choice: Choice
    voter: str | None = Field(
        None,
        min_length=1,
        max_length=MAX_VOTER,
        description="A text that identifies the voter, for example a random number. Each voter has "
        "one vote on a sequence. Only a hash of it is stored.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"choice": "left", "voter": "f3b1c9"}]}
    )


class Vote(Outgoing):
    """A stored vote.

    The answer does not say which basis was chosen, because the voter may see more pairs.
    """

    id: str
    pair_id: str
    choice: Choice


class TallyQuery(Incoming):
    """A filter of the votes."""

    clip_id: str | None = Field(
        None, min_length=1, max_length=100, description="Only votes on pairs of this clip."
    )


class Tally(Outgoing):
    """Votes as in Perera's Table 2."""

    keypose: int = Field(description="Number of votes for the version from keyposes.")
    uniform: int
    same: int = Field(description="Number of votes that both look the same.")
    share: float | None = Field(
        ge=0, le=1, description="keypose / (keypose + uniform); null without any of these votes."
    )
    interval: list[float] = Field(
        min_length=2, max_length=2, description="95 % confidence interval of `share` (Wilson)."
    )
    chance: float = Field(
        ge=0,
        le=1,
        description="Probability of a share at least this far from one half if nobody saw a "
        "difference (exact binomial test, which assumes independent votes).",
    )


class SequenceTally(Tally):
    """The votes on one clip with one model and one number of dimensions."""

    clip_id: str
    name: str
    dimensions: int

    @classmethod
    def of_sequence(cls, tally: studies.SequenceTally) -> SequenceTally:
        """The row of Table 2 as the API shows it."""
        return cls(
            **dict(Tally.model_validate(tally.votes)),
            clip_id=tally.clip_id,
            name=tally.name,
            dimensions=tally.dimensions,
        )


class StudyTally(Outgoing):
    """Table 2 of this library."""

    sequences: list[SequenceTally] = Field(
        description=f"The first {MAX_SEQUENCES} by name. Use `clip_id` for others. `total` and"
        " `left_share` count all sequences."
    )
    total: Tally
    left_share: float | None = Field(
        ge=0, le=1, description="Share of votes for the left side; about one half is expected."
    )

    @classmethod
    def of(cls, tally: studies.StudyTally) -> StudyTally:
        """The table as the API shows it."""
        return cls(
            sequences=[SequenceTally.of_sequence(row) for row in tally.sequences],
            total=Tally.model_validate(tally.total),
            left_share=tally.left_share,
        )
