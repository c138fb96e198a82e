"""The study of Perera's Table 2: people choose the low-dimensional motion that is nearer to the
original, of two.

A pair shows a clip reduced to the same number of dimensions by keyposes and by uniform poses. Their
sides are random. Neither the pair nor the form of its motions reveals them. Votes are counted by
sequence: a clip, a model and its dimensions.
"""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.analysis.low_dimensional.eigen_motion import PAPER_DIMENSIONS, Basis
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.motion.skeleton.resampling import resample
from app.numerics.binomial import fair_coin_probability, wilson_interval
from app.services import fields
from app.services.figures.animated_figure import animated_svg
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.views.animations import role_figure
from app.services.views.low_dimensional import Reduced, Reduction, frame_rate, keyposes_of, reduce
from app.services.views.views import MotionView
from app.store import studies as stored
from app.store.clips import repository as stored_clips
from app.store.database.paging import Page
from app.store.studies import Choice, PairRecord, VoteCount

MAX_SEQUENCES = 1000
"""Largest number of sequences that a tally lists; a tally of one clip lists those of the clip."""
MAX_VOTER = 200
"""Largest number of characters of a voter's name."""


class Side(StrEnum):
    """Which motion of a pair to show."""

    LEFT = "left"
    """One of the two reductions."""
    ORIGINAL = "original"
    """The original motion."""
    RIGHT = "right"
    """The other reduction."""


@dataclass(frozen=True, slots=True)
class Tally:
    """Counts of votes as in Table 2.

    keypose, uniform, same: numbers of votes; share: of the keypose votes among those that
    preferred one side, None without such votes; interval: 95 % confidence interval of the share
    (Wilson); chance: probability of a share at least as far from one half under random votes.
    """

    keypose: int
    uniform: int
    same: int
    share: float | None
    interval: tuple[float, float]
    chance: float


@dataclass(frozen=True, slots=True)
class SequenceTally:
    """The vote counts of one sequence."""

    clip_id: str
    name: str
    dimensions: int
    votes: Tally


@dataclass(frozen=True, slots=True)
class StudyTally:
    """The counts of each sequence and of all.

    left_share: share of the left side among the votes that preferred one side, None without such
    votes. A share far from one half shows that voters did not look.
    """

    sequences: tuple[SequenceTally, ...]
    total: Tally
    left_share: float | None


def draw_pair(
    lib: Library,
    clip_id: str,
    dimensions: int = PAPER_DIMENSIONS,
    model_clips: Sequence[str] = (),
) -> PairRecord:
    """Create a pair of a clip's two reductions, on random sides.

    The pair keeps the present keyposes; later changes do not affect it. Raises BadField,
    ClipNotFound, ClipNotReady, NotEnoughKeyposes.
    """
    clip = ready_clip(lib, clip_id)
    keyposes = keyposes_of(lib, clip, model_clips)
    for basis in Basis:
        # Errors must be raised here, and not when somebody looks at the pair.
        reduce(lib, clip, Reduction(dimensions, basis, keyposes=keyposes))
    key = json.dumps([clip_id, dimensions, keyposes])
    sequence = hashlib.sha256(key.encode()).hexdigest()
    left = secrets.choice(list(Basis))
    with lib.store.write() as tx:
        return stored.add_pair(tx, clip_id, dimensions, keyposes, sequence, left.value)


def get_pair(lib: Library, pair_id: str) -> PairRecord:
    """Return a pair by id. Raises NotFound."""
    with lib.store.read() as tx:
        return stored.get_pair(tx, pair_id)


def list_pairs(lib: Library, limit: int = 50, cursor: str | None = None) -> Page[PairRecord]:
    """One page of pairs, the newest first. Raises PageNotFound for a bad cursor."""
    with lib.store.read() as tx:
        return stored.list_pairs(tx, limit=limit, cursor=cursor).counted(stored.total_pairs(tx))


def delete_pair(lib: Library, pair_id: str) -> None:
    """Delete a pair and its votes. Raises NotFound."""
    with lib.store.write() as tx:
        stored.delete_pair(tx, pair_id)


def motion(lib: Library, pair_id: str, side: Side, fps: float | None = None) -> MotionView:
    """The motion on a side of a pair, resampled by time to `fps` (default 30 Hz).

    Raises NotFound, BadField, ClipNotReady.
    """
    pair = get_pair(lib, pair_id)
    rate = frame_rate(lib, ready_clip(lib, pair.clip_id), fps)
    result = _reduced(lib, pair, side)
    track = result.original if side is Side.ORIGINAL else result.reduced
    positions = resample(track.positions, track.rate, rate).astype(np.float32)
    return MotionView(rate, tuple(role.value for role in SUN_ROLES), SUN_PARENTS, positions)


def animation(lib: Library, pair_id: str) -> str:
    """The three motions in one animated picture, the original in the middle (fig. 12).

    Raises NotFound, ClipNotReady.
    """
    pair = get_pair(lib, pair_id)
    left, right = (_reduced(lib, pair, side) for side in (Side.LEFT, Side.RIGHT))
    figures = [
        role_figure(left.reduced.positions, Side.LEFT.value),
        role_figure(left.original.positions, Side.ORIGINAL.value),
        role_figure(right.reduced.positions, Side.RIGHT.value),
    ]
    return animated_svg(figures, left.original.rate, "Which one is nearer to the original?")


def vote(lib: Library, pair_id: str, choice: Choice | str, voter: str | None = None) -> str:
    """Store a vote on which side is nearer to the original; returns the id of the vote.

    voter: any text that identifies the voter, such as a random number of their page. Only its
    hash is stored. A voter has one vote on each sequence. Raises NotFound, BadField,
    AlreadyVoted.
    """
    try:
        chosen = Choice(choice)
    except ValueError:
        raise fields.bad_field("choice", f"must be one of {', '.join(Choice)}") from None
    if voter is not None and not 0 < len(voter) <= MAX_VOTER:
        raise fields.bad_field("voter", f"must have from 1 to {MAX_VOTER} characters")
    voter_hash = None if voter is None else hashlib.sha256(voter.encode()).hexdigest()
    with lib.store.write() as tx:
        return stored.add_vote(tx, stored.get_pair(tx, pair_id), chosen, voter_hash)


def tally(lib: Library, clip_id: str | None = None) -> StudyTally:
    """Count the votes on the pairs of one clip, or of all clips. Raises ClipNotFound."""
    with lib.store.read() as tx:
        if clip_id is not None:
            stored_clips.get(tx, clip_id)
        counts = stored.count_votes(tx, clip_id)
        names = stored_clips.get_many(tx, sorted({count.clip_id for count in counts}))
    by_sequence: dict[str, list[VoteCount]] = {}
    for count in counts:
        by_sequence.setdefault(count.sequence, []).append(count)
    sequences = [
        SequenceTally(
            group[0].clip_id, names[group[0].clip_id].name, group[0].dimensions, _tally(group)
        )
        for group in by_sequence.values()
    ]
    sequences.sort(key=lambda sequence: (sequence.name, sequence.clip_id, sequence.dimensions))
    left = sum(count.votes for count in counts if count.choice is Choice.LEFT)
    # "same" prefers no side, so it does not count in the shares
    decided = sum(count.votes for count in counts if count.choice is not Choice.SAME)
    return StudyTally(
        tuple(sequences[:MAX_SEQUENCES]), _tally(counts), left / decided if decided else None
    )


def _tally(counts: Iterable[VoteCount]) -> Tally:
    votes = {Basis.KEYPOSE: 0, Basis.UNIFORM: 0, None: 0}
    for count in counts:
        votes[_chosen(count)] += count.votes
    keypose, decided = votes[Basis.KEYPOSE], votes[Basis.KEYPOSE] + votes[Basis.UNIFORM]
    return Tally(
        keypose=keypose,
        uniform=votes[Basis.UNIFORM],
        same=votes[None],
        share=keypose / decided if decided else None,
        interval=wilson_interval(keypose, decided),
        chance=fair_coin_probability(keypose, decided),
    )


def _chosen(count: VoteCount) -> Basis | None:
    """The basis of the chosen side; None if the voter chose "same"."""
    left = Basis(count.left_basis)
    if count.choice is Choice.SAME:
        return None
    return left if count.choice is Choice.LEFT else _other(left)


def _other(basis: Basis) -> Basis:
    return Basis.UNIFORM if basis is Basis.KEYPOSE else Basis.KEYPOSE


def _reduced(lib: Library, pair: PairRecord, side: Side) -> Reduced:
    left = Basis(pair.left_basis)
    basis = _other(left) if side is Side.RIGHT else left
    clip = ready_clip(lib, pair.clip_id)
    return reduce(lib, clip, Reduction(pair.dimensions, basis, keyposes=pair.keyposes))
