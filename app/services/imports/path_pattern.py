"""Labels from paths: a pattern like `{person}/{task}/{take}.bvh`.

A name in braces is a label, a hint, or a key of the metadata. It stands for a part of a path
without `/`, as short as possible. `*` stands for any such part, and `**` for any folders. The whole
path must match. If the pattern has no ending of a file name, any ending matches.
"""

from __future__ import annotations

import re
from typing import Any

from app.services import clip_fields, fields
from app.services.imports.columns import BadColumn, metadata_key
from app.store.clips.metadata_values import from_cell

MAX_PATTERN = 500
"""Characters of a pattern."""
PATTERN_OF_PATHS = r"^[^{}]*(\{[^{}.=]*[^{}.=\s][^{}.=]*\}[^{}]*)+$"
"""What every pattern matches, as a regular expression for the description of the API."""
NO_FIELD = ("roles", "metadata")
"""Fields that a part of a path cannot be."""
FIELDS = tuple(name for name in (*clip_fields.LABELS, *clip_fields.HINTS) if name not in NO_FIELD)
_TOKEN = re.compile(r"\{([^{}]*)\}|(\*\*/?)|(\*)")


class PathPattern:
    """A pattern of paths that names labels."""

    def __init__(self, pattern: str) -> None:
        """Read a pattern. Raises BadField at "labels"."""
        if len(pattern) > MAX_PATTERN:
            raise fields.bad_field("labels", f"must not be longer than {MAX_PATTERN} characters")
        self._names: list[str] = []
        tidy = pattern.replace("\\", "/").removeprefix("./").strip("/")
        expression, end = "", 0
        for token in _TOKEN.finditer(tidy):
            expression += re.escape(tidy[end : token.start()]) + self._part(token)
            end = token.end()
        rest = tidy[end:]
        if "{" in rest or "}" in rest or not self._names:
            raise fields.bad_field("labels", "must be a path with names in braces, as {person}/*")
        self._expression = re.compile(expression + re.escape(rest) + _ending(tidy))

    def values(self, path: str) -> dict[str, Any] | None:
        """The labels and hints that a path gives, as clients send them; None if it does not match.

        A value of the metadata is read as `metadata_values.from_cell` reads it.
        """
        found = self._expression.fullmatch(fields.path(path) or "")
        if found is None:
            return None
        by_name = dict(zip(self._names, found.groups(), strict=True))
        values: dict[str, Any] = {name: by_name[name] for name in FIELDS if name in by_name}
        keys = {key: from_cell(text) for key, text in by_name.items() if key not in FIELDS}
        return values | ({"metadata": keys} if keys else {})

    def _part(self, token: re.Match[str]) -> str:
        name, folders, any_part = token.groups()
        if folders:
            return r"(?:[^/]+/)*" if folders.endswith("/") else ".*"
        if any_part:
            return "[^/]*?"
        try:
            key = name if name in FIELDS else metadata_key(name, FIELDS)
        except BadColumn as problem:
            raise fields.bad_field("labels", str(problem)) from problem
        if key in self._names:
            raise fields.bad_field("labels", f"names {{{key}}} twice")
        self._names.append(key)
        return "([^/]+?)"


def _ending(pattern: str) -> str:
    """Any ending of a file name for a pattern that has none."""
    return "" if "." in pattern.rpartition("/")[2] else r"\.[^./]+"
