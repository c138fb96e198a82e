"""Removes a person's name from texts."""

from __future__ import annotations

import re
from typing import Any

REPLACEMENT = "anonymous"
"""Replaces a name in a text that must not become empty, as a file name."""
_SEPARATORS = re.compile(r"[\W_]+")


class NameRemover:
    """Finds and replaces one name, in upper or lower case, with any separators between its parts.

    "Anna Smith" is found in `anna_smith_01.bvh`, in `AnnaSmith01` and alone. It is not found inside
    of a longer word: "Ann" is not in `anna.bvh`.
    """

    def __init__(self, name: str) -> None:
        parts = [re.escape(part) for part in _SEPARATORS.split(name) if part]
        text = r"[\W_]*".join(parts) or re.escape(name)
        before, after = _no_more(name[:1]), _no_more(name[-1:])
        self._pattern = re.compile(f"(?<!{before}){text}(?!{after})", re.IGNORECASE)
        self.has_letter = any(character.isalpha() for character in name)
        """A name without a letter, as "02", may mean anything in the clips of others."""

    def is_name(self, text: str) -> bool:
        """Whether a text is the name and nothing else."""
        return self._pattern.fullmatch(text.strip()) is not None

    def holds_name(self, text: str) -> bool:
        """Whether the name is anywhere in a text."""
        return self._pattern.search(text) is not None

    def without(self, text: str) -> str:
        """A text with REPLACEMENT for the name."""
        return self._pattern.sub(REPLACEMENT, text)

    def without_parts(self, path: str) -> str:
        """A path with REPLACEMENT for each part that is the name and nothing else."""
        parts = path.split("/")
        return "/".join(REPLACEMENT if self.is_name(part) else part for part in parts)

    def in_json(self, value: Any) -> Any:
        """JSON with REPLACEMENT for the name in all strings; keys of objects stay."""
        if isinstance(value, str):
            return self.without(value)
        if isinstance(value, dict):
            return {key: self.in_json(one) for key, one in value.items()}
        return [self.in_json(one) for one in value] if isinstance(value, list) else value


def _no_more(character: str) -> str:
    """The class of characters that continue a word with this first or last character."""
    if not character.isalnum():
        return r"[^\s\S]"  # nothing: such a character is no part of a word
    return r"\d" if character.isdigit() else r"[^\W\d_]"
