"""A tree of a library's labels: a "right leg kick" is a "kick", to "jog" is to "run".

The parent of a label is, in this order:

1. what people say: another label, or nothing;
2. for a phrase, its head: of the words before the first preposition that are no manner, direction
   or part of the body, the last that the lexicon of movement knows (a turn only alone), else the
   last one;
3. for an inflected word, its base form, if the library or the lexicon has that: *kicking*, *kick*;
4. for a word of the lexicon, the first word with the same meaning, or of the broader meaning.

Nodes are normalized words (`normalize`). A link that would close a circle is left out.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from app.models.words.language import lexicon
from app.models.words.language.inflection import base_form
from app.models.words.language.normalize import normalize_word

_PREPOSITIONS = """
with without of from to in into on onto at by over under through while and then for
"""
_MANNERS = """
left right both backward backwards forward forwards sideways up down upward downward straight
slow slowly fast quick quickly high low long short big small hard soft light heavy strong weak
tired exhausted active energetic old elderly young childish masculine feminine male female
drunk normal neutral relaxed happy sad angry proud depressed strutting sneaky aggressive
arm arms leg legs hand hands foot feet head knee knees elbow elbows shoulder shoulders hip hips
body upper lower front back side a an the one two cycle loop
"""
"""Words that say how, where or with what somebody moves."""
WEAK_HEAD = "turn"
"""The head only of a phrase without another action: to walk and turn left is to walk."""
_BEFORE_OTHERS = frozenset(_PREPOSITIONS.split())
_NO_HEADS = frozenset(_MANNERS.split())


class LinkKind(StrEnum):
    """Why a label has its parent."""

    PEOPLE = "people"
    """People said so."""
    PHRASE = "phrase"
    """The parent is the head of the phrase."""
    INFLECTION = "inflection"
    """The parent is the base form of the word."""
    LEXICON = "lexicon"
    """The parent has the same or a broader meaning."""


@dataclass(frozen=True, slots=True)
class Link:
    """The parent of a label, None for none, and why."""

    parent: str | None
    kind: LinkKind


@dataclass(frozen=True, slots=True)
class LabelTree:
    """links: by node; a node without a link is a root. Every parent is a node."""

    nodes: frozenset[str]
    links: Mapping[str, Link]

    def parent(self, node: str) -> str | None:
        """The parent of a node, None for a root."""
        link = self.links.get(node)
        return None if link is None else link.parent

    def path(self, label: str) -> tuple[str, ...]:
        """The node of a label and all nodes above it, the root last."""
        node: str | None = normalize_word(label)
        found: list[str] = []
        while node is not None:
            found.append(node)
            node = self.parent(node)
        return tuple(found)

    def is_kind(self, label: str, broad: str) -> bool:
        """Whether a label is the other one, or a kind of it."""
        return normalize_word(broad) in self.path(label)

    def kinds(self, label: str, labels: Iterable[str]) -> tuple[str, ...]:
        """Those of the labels that are this one, or kinds of it."""
        return tuple(one for one in labels if self.is_kind(one, label))

    def likeness(self, one: str, other: str) -> float:
        """2 d / (d1 + d2) of the depths of two labels and of their nearest common node; 0..1.

        Wu and Palmer, "Verb semantics and lexical selection", 1994. The depth of a root is 1. 0 if
        the labels have no node in common.
        """
        path, others = self.path(one), self.path(other)
        common = sum(node in others for node in path)
        return 2.0 * common / (len(path) + len(others))


def label_tree(labels: Collection[str], said: Mapping[str, str | None]) -> LabelTree:
    """The tree of labels. said: the parent of a label as people say, None for none."""
    given = {normalize_word(label): parent for label, parent in said.items()}
    given = {label: parent and normalize_word(parent) for label, parent in given.items()}
    own = {normalize_word(label) for label in labels} - {""}
    links: dict[str, Link] = {}
    waiting, seen = sorted(own | given.keys()), set[str]()
    # what people say comes first, so that a link of ours never closes a circle with it
    for label, parent in given.items():
        if not _closes_circle(links, label, parent):
            links[label] = Link(parent, LinkKind.PEOPLE)
    while waiting:
        label = waiting.pop()
        if label in seen:
            continue
        seen.add(label)
        if label not in links:
            link = _proposed(label, own)
            if link is not None and not _closes_circle(links, label, link.parent):
                links[label] = link
        parent = links[label].parent if label in links else None
        if parent is not None:
            waiting.append(parent)
    return LabelTree(frozenset(seen), links)


def closes_circle(said: Mapping[str, str | None]) -> str | None:
    """A label that is above itself in what people say, None if there is none."""
    parents = {
        normalize_word(label): parent and normalize_word(parent) for label, parent in said.items()
    }
    for label in parents:
        above, steps = parents.get(label), 0
        while above is not None and steps <= len(parents):
            if above == label:
                return label
            above, steps = parents.get(above), steps + 1
    return None


def _closes_circle(links: Mapping[str, Link], label: str, parent: str | None) -> bool:
    while parent is not None:
        if parent == label:
            return True
        link = links.get(parent)
        parent = None if link is None else link.parent
    return False


def _proposed(label: str, own: Collection[str]) -> Link | None:
    if "_" in label:
        head = _head(label)
        return None if head is None else Link(head, LinkKind.PHRASE)
    if lexicon.is_known(label):
        parent = lexicon.parent(label)
        return None if parent is None else Link(parent, LinkKind.LEXICON)
    base = base_form(label, lambda word: word != label and (word in own or lexicon.is_known(word)))
    return None if base is None or base == label else Link(base, LinkKind.INFLECTION)


def _head(phrase: str) -> str | None:
    """The head of a phrase, None if no word can be it."""
    words: list[str] = []
    for word in phrase.split("_"):
        if word in _BEFORE_OTHERS and words:
            break
        words.append(word)
    heads = [word for word in words if word not in _NO_HEADS and word.isalpha()]
    if not heads:
        return None
    bases = {word: base_form(word, lexicon.is_known) for word in heads}
    known = [base for word in heads if (base := bases[word]) is not None]
    actions = [word for word in known if word != WEAK_HEAD] or known
    return actions[-1] if actions else heads[-1]
