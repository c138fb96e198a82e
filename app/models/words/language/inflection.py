"""Base forms of English words: jumping, jumps and jumped are jump; knives are a knife.

Rules make candidates, and whoever asks says which of them are words: only a base form that
is known is ever taken, so that "bus" stays and "wing" is not the present of "w". Phrases
(left_legs) are taken apart at their underscores. After the rules of regular English verbs and
nouns; the irregular ones are those of movement.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice, product

IRREGULAR: dict[str, str] = {
    form: base
    for base, forms in {
        "be": "is are was were been",
        "beat": "beaten",
        "bend": "bent",
        "bite": "bit bitten",
        "blow": "blew blown",
        "break": "broke broken",
        "bring": "brought",
        "catch": "caught",
        "child": "children",
        "climb": "clomb",
        "come": "came",
        "creep": "crept",
        "dig": "dug",
        "dive": "dove",
        "do": "did done",
        "draw": "drew drawn",
        "drink": "drank drunk",
        "drive": "drove driven",
        "eat": "ate eaten",
        "fall": "fell fallen",
        "fight": "fought",
        "fling": "flung",
        "fly": "flew flown",
        "foot": "feet",
        "get": "got gotten",
        "give": "gave given",
        "go": "went gone",
        "grind": "ground",
        "hang": "hung",
        "hold": "held",
        "keep": "kept",
        "kneel": "knelt",
        "knife": "knives",
        "lead": "led",
        "lean": "leant",
        "leap": "leapt",
        "leave": "left",
        "lie": "lay lain lying",
        "make": "made",
        "man": "men",
        "meet": "met",
        "ride": "rode ridden",
        "rise": "rose risen",
        "run": "ran",
        "see": "saw seen",
        "shake": "shook shaken",
        "shoot": "shot",
        "sing": "sang sung",
        "sit": "sat",
        "slide": "slid",
        "sling": "slung",
        "sneak": "snuck",
        "spin": "spun",
        "spring": "sprang sprung",
        "stand": "stood",
        "steal": "stole stolen",
        "stick": "stuck",
        "strike": "struck stricken",
        "sweep": "swept",
        "swim": "swam swum",
        "swing": "swung",
        "take": "took taken",
        "teach": "taught",
        "tear": "tore torn",
        "throw": "threw thrown",
        "tread": "trod trodden",
        "wake": "woke woken",
        "weep": "wept",
        "woman": "women",
        "write": "wrote written",
    }.items()
    for form in forms.split()
}
"""Base by form."""

_VOWELS = frozenset("aeiouy")
_SHORTEST = 2
"""Letters of a base form."""
_MAX_PHRASES = 64
"""Combinations of base forms of a phrase's words that are looked at."""

IsWord = Callable[[str], bool]


def base_form(word: str, is_word: IsWord) -> str | None:
    """The likeliest base form of `word` that is a word; the word itself comes first.

    None where neither it nor any base form is one. Words are normalized (word_vocabulary).
    """
    return next(filter(is_word, (word, *base_forms(word))), None)


def base_forms(word: str) -> tuple[str, ...]:
    """Candidates for the base form of `word`, other than itself, the likeliest first."""
    parts = word.split("_")
    choices = [tuple(dict.fromkeys((part, *_of_one(part)))) for part in parts]
    phrases = islice(("_".join(chosen) for chosen in product(*choices)), _MAX_PHRASES)
    return tuple(phrase for phrase in phrases if phrase != word)


def _of_one(word: str) -> Iterator[str]:
    if word in IRREGULAR:
        yield IRREGULAR[word]
    for base in _by_rule(word.removesuffix("'s")):
        if len(base) >= _SHORTEST and not _VOWELS.isdisjoint(base):
            yield base


def _by_rule(word: str) -> Iterator[str]:
    if word.endswith("ies"):
        yield word[:-3] + "y"
    if word.endswith("es"):
        yield word[:-1]
        yield word[:-2]
    elif word.endswith("s") and not word.endswith("ss"):
        yield word[:-1]
    if word.endswith("ied"):
        yield word[:-3] + "y"
    for ending in ("ing", "ed", "er"):
        if word.endswith(ending):
            yield from _before(word.removesuffix(ending))
    if word.endswith("ers"):
        yield from _before(word[:-3])
    if word.endswith("ly"):
        yield word[:-2]


def _before(stem: str) -> Iterator[str]:
    """What may stand before -ing, -ed or -er: walk-, jog(g)-, wav(e)-."""
    yield stem
    yield stem + "e"
    if len(stem) > _SHORTEST and stem[-1] == stem[-2]:
        yield stem[:-1]
