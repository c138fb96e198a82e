"""The study of Table 2: blind pairs that do not change, votes, and their tally."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from app.analysis.low_dimensional.eigen_motion import Basis
from app.errors import AlreadyVoted, BadField, ClipNotFound, NotEnoughKeyposes, NotFound
from app.numerics.arrays import FloatArray
from app.services.library.library import Library
from app.services.views import low_dimensional, studies
from app.services.views.low_dimensional import Reduction
from app.services.views.studies import Side
from app.store.clips.record import ClipRecord
from app.store.studies import PairRecord
from tests.libraries import FindClip


@pytest.fixture
def study(ready_library: Library) -> Iterator[Library]:
    """A library whose pairs go with the test."""
    yield ready_library
    for pair in studies.list_pairs(ready_library, limit=1000).items:
        studies.delete_pair(ready_library, pair.id)


@pytest.fixture
def clip(clip_of: FindClip) -> ClipRecord:
    return clip_of("ada", "wave")


def _side_of(pair: PairRecord, basis: Basis) -> Side:
    return Side.LEFT if pair.left_basis == basis else Side.RIGHT


def _shown(lib: Library, clip: ClipRecord, basis: Basis, dimensions: int) -> FloatArray:
    return low_dimensional.view(lib, clip.id, Reduction(dimensions, basis)).motion.positions


def test_the_sides_show_the_two_reductions_and_the_original_motion(
    study: Library, clip: ClipRecord
) -> None:
    pair = studies.draw_pair(study, clip.id, 2)
    for basis in Basis:
        view = studies.motion(study, pair.id, _side_of(pair, basis))
        np.testing.assert_array_equal(view.positions, _shown(study, clip, basis, 2))
    whole = low_dimensional.reduce(study, clip, Reduction(2)).original.positions
    view = studies.motion(study, pair.id, Side.ORIGINAL)
    np.testing.assert_allclose(view.positions, whole, atol=1e-6)


def test_sides_are_random_and_do_not_change(study: Library, clip: ClipRecord) -> None:
    pairs = [studies.draw_pair(study, clip.id) for _ in range(40)]
    lefts = [pair.left_basis for pair in pairs]
    assert 5 < lefts.count("keypose") < 35  # else once in ten million
    assert len({pair.sequence for pair in pairs}) == 1
    again = [studies.get_pair(study, pair.id).left_basis for pair in pairs]
    assert again == lefts


def test_a_pair_does_not_change_with_the_keyposes(
    study: Library, clip: ClipRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    pair = studies.draw_pair(study, clip.id, 2)
    before = {side: studies.motion(study, pair.id, side).positions for side in Side}
    monkeypatch.setattr(
        low_dimensional, "keypose_frames", lambda lib, clip_id, track: np.array([0, 11, 33])
    )
    for side in Side:
        np.testing.assert_array_equal(studies.motion(study, pair.id, side).positions, before[side])
    later = studies.draw_pair(study, clip.id, 2)
    assert later.sequence != pair.sequence


def test_the_picture_shows_three_motions_and_does_not_reveal_the_bases(
    study: Library, clip: ClipRecord
) -> None:
    pair = studies.draw_pair(study, clip.id)
    picture = studies.animation(study, pair.id)
    assert [picture.index(f">{side}<") for side in ("left", "original", "right")] == sorted(
        picture.index(f">{side}<") for side in ("left", "original", "right")
    )
    assert "keypose" not in picture
    assert "uniform" not in picture


def test_votes_are_counted_as_in_table_2(
    study: Library, clip: ClipRecord, clip_of: FindClip
) -> None:
    other = clip_of("bruno", "wave")
    for one, keypose, uniform, same in ((clip, 8, 2, 1), (other, 3, 3, 0)):
        for number in range(keypose + uniform + same):
            pair = studies.draw_pair(study, one.id)
            preferred = Basis.KEYPOSE if number < keypose else Basis.UNIFORM
            choice = _side_of(pair, preferred).value if number < keypose + uniform else "same"
            studies.vote(study, pair.id, choice, f"voter {number}")
    found = studies.tally(study)
    rows = {row.clip_id: row.votes for row in found.sequences}
    assert (rows[clip.id].keypose, rows[clip.id].uniform, rows[clip.id].same) == (8, 2, 1)
    assert rows[clip.id].share == pytest.approx(0.8)
    assert rows[clip.id].chance == pytest.approx(0.109375)
    assert rows[other.id].share == 0.5
    assert rows[other.id].chance == 1.0
    assert found.total.share == pytest.approx(11 / 16)
    low, high = found.total.interval
    assert low < 11 / 16 < high
    assert found.left_share is not None
    assert studies.tally(study, clip.id).total == rows[clip.id]


def test_a_vote_for_same_counts_for_neither_side(study: Library, clip: ClipRecord) -> None:
    pair = studies.draw_pair(study, clip.id)
    assert studies.tally(study).total.share is None
    studies.vote(study, pair.id, "same")
    found = studies.tally(study)
    assert (found.total.same, found.total.share, found.left_share) == (1, None, None)
    assert found.total.interval == (0.0, 1.0)


def test_a_named_voter_has_one_vote_and_unnamed_votes_all_count(
    study: Library, clip: ClipRecord
) -> None:
    first, second = (studies.draw_pair(study, clip.id) for _ in range(2))
    studies.vote(study, first.id, "left", "someone")
    with pytest.raises(AlreadyVoted):
        studies.vote(study, second.id, "right", "someone")
    for _ in range(3):
        studies.vote(study, first.id, "left")
    found = studies.tally(study).total
    assert found.keypose + found.uniform == 4


def test_impossible_pairs_and_votes_are_refused(
    study: Library, clip: ClipRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(BadField, match="dimensions"):
        studies.draw_pair(study, clip.id, 500)
    with pytest.raises(ClipNotFound):
        studies.draw_pair(study, "clip_none")
    with pytest.raises(NotFound):
        studies.motion(study, "pair_none", Side.LEFT)
    with pytest.raises(ClipNotFound):
        studies.tally(study, "clip_none")
    pair = studies.draw_pair(study, clip.id)
    with pytest.raises(BadField, match="left, right, same"):
        studies.vote(study, pair.id, "both")
    with pytest.raises(BadField, match="voter"):
        studies.vote(study, pair.id, "left", "")
    none = np.zeros(0, dtype=int)
    monkeypatch.setattr(low_dimensional, "keypose_frames", lambda lib, clip_id, track: none)
    with pytest.raises(NotEnoughKeyposes):
        studies.draw_pair(study, clip.id)
    assert len(studies.list_pairs(study).items) == 1
