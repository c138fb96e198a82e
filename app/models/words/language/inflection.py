"""Base forms of English words: jumping, jumps, jumped -> jump; knives -> knife.

Rules produce candidates, and the caller decides which of them are words. Only words are used. So
"bus" stays as it is, and "wing" does not become "w". Phrases (left_legs) are split at their
underscores. The rules are those of regular English verbs and nouns; the list of irregular ones
covers movement.
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
"""Base form by inflected form."""

_NOT_AGENTS = """
shower slipper locker roller lighter stroller drawer counter corner cover dresser trailer
poster letter butter cracker jumper sweater trainer loafer
"""
NOT_AGENTS = frozenset(_NOT_AGENTS.split())
"""Words in -er that do not name somebody who does what the word without -er says."""

_VOWELS = frozenset("aeiouy")
_MIN_LETTERS = 2
"""Smallest number of letters of a base form."""
_MAX_PHRASES = 64
"""Largest number of combinations of base forms that are tried for a phrase."""

IsWord = Callable[[str], bool]


def base_form(word: str, is_word: IsWord) -> str | None:
    """The most likely base form of `word` that is a word; the word itself comes first.

    None if neither the word nor a base form is one. Words are normalized (see `normalize`).
    """
    return next(filter(is_word, (word, *base_forms(word))), None)


def base_forms(word: str) -> tuple[str, ...]:
    """Candidates for the base form of `word`, without itself, the most likely first."""
    parts = word.split("_")
    choices = [tuple(dict.fromkeys((part, *_of_one(part)))) for part in parts]
    phrases = islice(("_".join(chosen) for chosen in product(*choices)), _MAX_PHRASES)
    return tuple(phrase for phrase in phrases if phrase != word)


def _of_one(word: str) -> Iterator[str]:
    """Candidates for the base form of a word without underscores, the most likely first."""
    if word in IRREGULAR:
        yield IRREGULAR[word]
    # A base form has a vowel: this removes most wrong candidates.
    for base in _by_rule(word.removesuffix("'s")):
        if len(base) >= _MIN_LETTERS and not _VOWELS.isdisjoint(base):
            yield base


def _by_rule(word: str) -> Iterator[str]:
    """Candidates for the base form of a regular verb, noun or adverb."""
    if word.endswith("ies"):
        yield word[:-3] + "y"
    if word.endswith("es"):
        yield word[:-1]
        yield word[:-2]
    elif word.endswith("s") and not word.endswith("ss"):
        yield word[:-1]
    if word.endswith("ied"):
        yield word[:-3] + "y"
    is_agent = word.removesuffix("s") not in NOT_AGENTS
    for ending in ("ing", "ed", "er"):
        if word.endswith(ending) and (ending != "er" or is_agent):
            yield from _before(word.removesuffix(ending))
    if word.endswith("ers") and is_agent:
        yield from _before(word[:-3])
    if word.endswith("ly"):
        yield word[:-2]


def _before(stem: str) -> Iterator[str]:
    """Possible base forms of a stem before -ing, -ed or -er: walk-, jog(g)-, wav(e)-."""
    yield stem
    yield stem + "e"
    if len(stem) > _MIN_LETTERS and stem[-1] == stem[-2]:  # a doubled letter
        yield stem[:-1]
