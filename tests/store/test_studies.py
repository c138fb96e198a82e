"""Pairs and votes: a voter votes once on a sequence, and votes are counted by side and choice."""

from __future__ import annotations

import pytest

from app.errors import AlreadyVoted, NotFound, PageNotFound
from app.store import studies
from app.store.clips import repository as clips
from app.store.store import Store
from app.store.studies import Choice, PairRecord
from tests.store.conftest import AddClip


@pytest.fixture
def pair(store: Store, add_clip: AddClip) -> PairRecord:
    clip = add_clip("dance", ready=True)
    with store.write() as tx:
        return studies.add_pair(tx, clip.id, 3, {clip.id: [4, 9]}, "s1", "keypose")


def _another(store: Store, pair: PairRecord, sequence: str = "s1") -> PairRecord:
    with store.write() as tx:
        return studies.add_pair(
            tx, pair.clip_id, pair.dimensions, pair.keyposes, sequence, "uniform"
        )


def _vote(store: Store, pair: PairRecord, choice: Choice, voter: str | None = None) -> str:
    with store.write() as tx:
        return studies.add_vote(tx, pair, choice, voter)


def test_a_pair_is_read_as_it_was_written(store: Store, pair: PairRecord) -> None:
    with store.read() as tx:
        assert studies.get_pair(tx, pair.id) == pair
    assert pair.keyposes == {pair.clip_id: [4, 9]}


def test_pairs_are_listed_in_pages_newest_first(store: Store, pair: PairRecord) -> None:
    made = [pair, *(_another(store, pair) for _ in range(4))]
    seen: list[str] = []
    cursor = None
    for _ in range(3):
        with store.read() as tx:
            page = studies.list_pairs(tx, limit=2, cursor=cursor)
        seen += [one.id for one in page.items]
        cursor = page.next
    assert seen == [one.id for one in reversed(made)]
    assert cursor is None
    with store.read() as tx, pytest.raises(PageNotFound):
        studies.list_pairs(tx, cursor="nonsense")


def test_votes_are_counted_by_side_and_choice(store: Store, pair: PairRecord) -> None:
    other = _another(store, pair)
    for choice in (Choice.LEFT, Choice.LEFT, Choice.SAME):
        _vote(store, pair, choice)
    _vote(store, other, Choice.LEFT)
    with store.read() as tx:
        counts = studies.count_votes(tx)
        assert studies.count_votes(tx, pair.clip_id) == counts
        assert studies.count_votes(tx, "another") == ()
    assert [(c.left_basis, c.choice.value, c.votes) for c in counts] == [
        ("keypose", "left", 2), ("keypose", "same", 1), ("uniform", "left", 1),
    ]  # fmt: skip


def test_a_voter_votes_once_on_all_pairs_of_a_sequence(store: Store, pair: PairRecord) -> None:
    _vote(store, pair, Choice.LEFT, "v1")
    for again in (pair, _another(store, pair)):
        with pytest.raises(AlreadyVoted):
            _vote(store, again, Choice.RIGHT, "v1")
    _vote(store, pair, Choice.RIGHT, "v2")
    _vote(store, _another(store, pair, "s2"), Choice.LEFT, "v1")
    with store.read() as tx:
        assert sum(count.votes for count in studies.count_votes(tx)) == 3


def test_deleting_a_clip_deletes_its_pairs_and_their_votes(store: Store, pair: PairRecord) -> None:
    other = _another(store, pair)
    for one in (pair, other):
        _vote(store, one, Choice.LEFT)
    with store.write() as tx:
        studies.delete_pair(tx, pair.id)
    with store.read() as tx:
        assert [count.votes for count in studies.count_votes(tx)] == [1]
    with store.write() as tx:
        clips.delete_clip(tx, pair.clip_id)
    with store.read() as tx:
        assert studies.count_votes(tx) == ()
        assert studies.list_pairs(tx).items == ()


def test_an_unknown_pair_is_not_found(store: Store) -> None:
    with store.write() as tx:
        with pytest.raises(NotFound, match="pair_none"):
            studies.get_pair(tx, "pair_none")
        with pytest.raises(NotFound, match="pair_none"):
            studies.delete_pair(tx, "pair_none")
