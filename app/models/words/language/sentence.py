"""Reads a query of words, phrases or sentences into words to find and words to exclude.

*an old man waves with his left hand* becomes old, wave, left, hand. Words and phrases of the
library are used, the longest phrases first (left_hand if that is a label), and all other words
except function words. A word after a minus (-left), or after *without* in a sentence, is excluded.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

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

NEGATIONS = frozenset({"no", "not", "never", "without"})
"""The next word of the sentence after one of these words is excluded."""


@dataclass(frozen=True, slots=True)
class QueryWords:
    """The words of a query: distinct, normalized, in their order.

    included: words to find; excluded: words that a hit must not have.
    """

    included: tuple[str, ...]
    excluded: tuple[str, ...]


def read_query(texts: Iterable[str], is_word: Callable[[str], bool]) -> QueryWords:
    """Read `texts`; each is a word, a phrase or a sentence.

    is_word: whether the library has a normalized word, inflected or not.
    """
    included: list[str] = []
    excluded: list[str] = []
    for text in texts:
        for word, is_excluded in _words_of(text.strip(), is_word):
            (excluded if is_excluded else included).append(word)
    return QueryWords(tuple(dict.fromkeys(included)), tuple(dict.fromkeys(excluded)))


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
        if word and (is_minus or is_word(word) or word not in FUNCTION_WORDS):
            yield word, is_minus or is_negated
            is_negated = False
        is_negated |= word in NEGATIONS
        position += length


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
