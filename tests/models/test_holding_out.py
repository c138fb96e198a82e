from __future__ import annotations

import numpy as np

from app.models.holding_out import HeldOut, rounds_by_distance, rounds_of_strangers


def test_strangers_at_new_tasks_have_neither_label_in_the_training() -> None:
    persons = [p for p in "abcdef" for _ in range(7)]
    tasks = [t for _ in range(6) for t in "rstuvwx"]
    found = list(rounds_of_strangers(persons, tasks))
    assert len(found) == 5
    for kind, train, probe in found:
        assert kind is HeldOut.STRANGERS
        for labels in (persons, tasks):
            assert not {labels[i] for i in train} & {labels[i] for i in probe}


def test_strangers_need_three_persons_and_three_tasks() -> None:
    few, none, many = ["a", "b"] * 4, [None] * 8, list("abcdefgh")
    assert not list(rounds_of_strangers(few, many))
    assert not list(rounds_of_strangers(many, none))


def test_far_takes_are_asked_without_their_neighbors() -> None:
    takes = np.random.default_rng(0).permutation(np.arange(1, 11))
    names = [f"walk_{take}" for take in takes]
    (_, train, probe), (_, after, before) = rounds_by_distance(["a"] * 10, ["walk"] * 10, names)
    assert sorted(takes[train]) == [1, 2, 3, 4, 5, 6]
    assert sorted(takes[probe]) == [9, 10]
    assert sorted(takes[after]) == [5, 6, 7, 8, 9, 10]
    assert sorted(takes[before]) == [1, 2]


def test_far_takes_need_four_takes_with_both_labels() -> None:
    names = ["1", "2", "3", "4"]
    assert not list(rounds_by_distance(["a"] * 3, ["walk"] * 3, names[:3]))
    assert not list(rounds_by_distance(["a"] * 4, [None] * 4, names))
    assert not list(rounds_by_distance(["a"] * 4, ["walk"] * 4, ["1", "1", "2", "3"]))
    assert len(list(rounds_by_distance(["a"] * 4, ["walk"] * 4, names))) == 2
