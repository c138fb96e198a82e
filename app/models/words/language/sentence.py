"""Reads a query of words, phrases or sentences into words to find and words to exclude.

*an old man waves with his left hand* becomes old, wave, left, hand. Words and phrases of the
library are used, the longest phrases first (left_hand if that is a label), and all other words
except function words and light verbs. A word after a minus (-left), or after *without* in a
sentence, is excluded.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from app.models.words.language.inflection import base_forms
from app.models.words.language.normalize import normalize_word

MAX_PHRASE_WORDS = 4
"""Largest number of words of a phrase in a sentence."""

_TOKEN = re.compile(r"(?<![\w-])-?[\w'’]+(?:-[\w'’]+)*")

_FUNCTION_WORDS = """
a an the this that these those some any each every all no one another other
i you he she it we they me him her us them his hers its our your their my mine theirs
himself herself itself themselves who whom whose which what where when how why
is are was were be been being am do does did doing done has have had having
will would can could shall should may might must
and or but nor so yet if then than as while whilst because until though
of in on at to from by with without within into onto off out over under about against
between through during before after above below around across along toward towards near
for like via per up down
not very too quite rather just only also again still there here now once
man men woman women person persons people human guy guys lady ladies gentleman boy boys
girl girls child children kid kids somebody someone anybody anyone everybody everyone
actor actors actress performer performers dancer player figure character body subject
motion motions movement movements clip clips animation animations video action actions
find show search me please
"""
FUNCTION_WORDS = frozenset(_FUNCTION_WORDS.split())
"""Words that are ignored in a sentence, except if a clip of the library has them."""

_LIGHT_VERBS = """
make take do perform get have go put let begin start try continue keep use be become seem come
execute show act
"""
LIGHT_VERBS = frozenset(_LIGHT_VERBS.split())
"""Verbs that say nothing about a movement: *takes a step* is a step. Inflected or not, they are
ignored like function words."""

THINGS = frozenset({"box", "boot", "row", "type", "fire", "light", "hook", "play", "cross", "lead"})
"""Words of our lexicon that are another thing as a noun: *lifts a box* has no punch."""
_ARTICLES = "a an the this that these those his her its their my your our some any each every"
ARTICLES = frozenset(_ARTICLES.split())
"""The word after one of these is a noun, or describes one."""

NEGATIONS = frozenset({"no", "not", "never", "without"})
"""The next word of the sentence after one of these words is excluded."""


@dataclass(frozen=True, slots=True)
class QueryWords:
    """The words of a query: distinct, normalized, in their order.

    included: words to find; excluded: words that a hit must not have; things: the included words
    that name a thing here, and not a movement that is written the same (see THINGS).
    """

    included: tuple[str, ...]
    excluded: tuple[str, ...]
    things: frozenset[str] = frozenset()


def read_query(texts: Iterable[str], is_word: Callable[[str], bool]) -> QueryWords:
    """Read `texts`; each is a word, a phrase or a sentence.

    is_word: whether the library has a normalized word, inflected or not.
    """
    included: list[str] = []
    excluded: list[str] = []
    things: set[str] = set()
    for text in texts:
        for word, is_excluded in _words_of(text.strip(), is_word):
            (excluded if is_excluded else included).append(word)
        things |= _things_of(text)
    return QueryWords(
        tuple(dict.fromkeys(included)), tuple(dict.fromkeys(excluded)), frozenset(things)
    )


def _words_of(text: str, is_word: Callable[[str], bool]) -> Iterator[tuple[str, bool]]:
    """(normalized word, whether it is excluded) for each word of `text`."""
    whole = normalize_word(text)
    if whole and not text.startswith("-") and is_word(whole):
        yield whole, False
        return
    tokens = [token.replace("’", "'") for token in _TOKEN.findall(text)]
    if len(tokens) == 1:  # a single word is used even if it is a function word
        word = normalize_word(tokens[0])
        if word:
            yield word, tokens[0].startswith("-")
        return
    position, is_negated = 0, False
    while position < len(tokens):
        word, length = _longest_phrase(tokens[position:], is_word)
        is_minus = tokens[position].startswith("-")
        if word and (is_minus or is_word(word) or not _is_ignored(word)):
            yield word, is_minus or is_negated
            is_negated = False
        is_negated |= word in NEGATIONS
        position += length


def _is_ignored(word: str) -> bool:
    return word in FUNCTION_WORDS or not LIGHT_VERBS.isdisjoint((word, *base_forms(word)))


def _things_of(text: str) -> set[str]:
    """The words of a text that name things: THINGS, singular or plural, right after an article."""
    words = [normalize_word(token) for token in _TOKEN.findall(text)]
    return {
        word
        for before, word in pairwise(words)
        if before in ARTICLES and not THINGS.isdisjoint((word, *base_forms(word)))
    }


def _longest_phrase(tokens: list[str], is_word: Callable[[str], bool]) -> tuple[str, int]:
    """The longest phrase of the library at the start of `tokens`, else the first word.

    Also returns its number of tokens.
    """
    for length in range(min(MAX_PHRASE_WORDS, len(tokens)), 1, -1):
        if any(token.startswith("-") for token in tokens[1:length]):
            continue  # a minus begins a new word
        phrase = normalize_word(" ".join(tokens[:length]))
        if is_word(phrase):
            return phrase, length
    return normalize_word(tokens[0]).removesuffix("'s"), 1
