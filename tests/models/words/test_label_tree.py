"""The tree of labels: heads of phrases, base forms, the lexicon, and what people say."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.models.words.language.label_tree import LabelTree, LinkKind, closes_circle, label_tree

LABELS = ("right leg kick", "kick", "jog", "run", "slow_walk", "walk", "stand")


@pytest.mark.parametrize(
    ("label", "parent", "kind"),
    [
        ("right leg kick", "kick", LinkKind.PHRASE),
        ("kick left leg", "kick", LinkKind.PHRASE),
        ("walk backwards", "walk", LinkKind.PHRASE),
        ("High-Kick", "kick", LinkKind.PHRASE),
        ("walk with a box", "walk", LinkKind.PHRASE),
        ("walk-turn-left", "walk", LinkKind.PHRASE),
        ("turn left", "turn", LinkKind.PHRASE),
        ("leg kicking", "kick", LinkKind.PHRASE),
        ("jog", "run", LinkKind.LEXICON),
        ("sprint", "run", LinkKind.LEXICON),
        ("run", "move", LinkKind.LEXICON),
        ("kicking", "kick", LinkKind.INFLECTION),
    ],
)
def test_a_label_gets_its_parent(label: str, parent: str, kind: LinkKind) -> None:
    tree = label_tree([label], {})
    link = tree.links[tree.path(label)[0]]
    assert (link.parent, link.kind) == (parent, kind)
    assert tree.is_kind(label, parent)
    assert not tree.is_kind(parent, label)


@pytest.mark.parametrize("label", ["stand", "left", "left arm", "xyz", "a of b", "move"])
def test_a_label_without_a_head_is_a_root(label: str) -> None:
    assert label_tree([label], {}).path(label)[1:] in ((), ("b",))


def test_kinds_are_found_through_all_levels() -> None:
    tree = label_tree([*LABELS, "slow jog"], {})
    assert tree.kinds("run", [*LABELS, "slow jog"]) == ("jog", "run", "slow jog")
    assert set(tree.kinds("move", LABELS)) >= {"jog", "run", "slow_walk", "walk"}
    assert tree.kinds("jog", LABELS) == ("jog",)
    assert tree.kinds("nosuch", LABELS) == ()


def test_people_decide() -> None:
    tree = label_tree(LABELS, {"jog": "walk", "right leg kick": None, "walk": "exercise"})
    assert tree.path("jog") == ("jog", "walk", "exercise")
    assert tree.path("right leg kick") == ("right_leg_kick",)
    assert tree.links["jog"].kind is LinkKind.PEOPLE


def test_what_people_say_never_closes_a_circle_with_the_lexicon() -> None:
    tree = label_tree(LABELS, {"run": "jog"})
    assert tree.path("run")[:2] == ("run", "jog")
    assert "run" not in tree.path("jog")[1:]


def test_a_circle_is_found() -> None:
    assert closes_circle({"a": "b", "b": "c", "c": None}) is None
    assert closes_circle({"x": "a", "a": "b", "b": "a"}) in ("a", "b")
    assert closes_circle({"A b": "a_b"}) == "a_b"


def test_likeness_grows_with_the_common_path() -> None:
    """Wu and Palmer, by hand: jog is move/run/jog, run is move/run, walk is move/walk."""
    tree = label_tree(LABELS, {})
    assert tree.likeness("jog", "jog") == 1
    assert tree.likeness("jog", "run") == pytest.approx(2 * 2 / (3 + 2))
    assert tree.likeness("jog", "walk") == pytest.approx(2 * 1 / (3 + 2))
    assert tree.likeness("jog", "stand") == 0


_words = st.sampled_from(["run", "jog", "kick", "left_kick", "walk", "slow walk", "a", "b", "c"])


@given(st.lists(_words), st.dictionaries(_words, st.none() | _words))
def test_every_path_ends(labels: list[str], said: dict[str, str | None]) -> None:
    tree: LabelTree = label_tree(labels, said)
    for node in tree.nodes:
        path = tree.path(node)
        assert len(set(path)) == len(path)
        assert set(path) <= tree.nodes
