"""What the caller of an import says about all of its files.

A value counts for each file for which nothing more special says otherwise: a cell of the file's
row in a manifest comes first, then the pattern of paths, then the values for all files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from app.services import clip_fields
from app.services.clips.merging import OnConflict
from app.services.imports.path_pattern import PathPattern


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """values: labels and metadata for all files, as clients send them; pattern: labels from paths,
    as `PathPattern` reads them; overwrite: whether what comes replaces labels that somebody edited.
    """

    values: Mapping[str, Any] = field(default_factory=dict)
    pattern: str | None = None
    overwrite: bool = False

    def check(self) -> None:
        """Raises BadField for a bad value or pattern."""
        clip_fields.checked(self.values)
        self.path_pattern()

    def path_pattern(self) -> PathPattern | None:
        """The pattern, read. Raises BadField."""
        return None if self.pattern is None else PathPattern(self.pattern)

    @property
    def on_conflict(self) -> OnConflict:
        """What happens to labels that differ from those of stored clips."""
        return OnConflict.UPDATE if self.overwrite else OnConflict.MERGE

    def as_payload(self) -> dict[str, Any]:
        """The options as a job stores them."""
        return {
            "values": dict(self.values),
            "pattern": self.pattern,
            "overwrite": self.overwrite,
        }

    @classmethod
    def of_payload(cls, payload: Mapping[str, Any] | None) -> ImportOptions:
        """The options of a stored job. A job of an earlier version has none."""
        return cls(**payload) if payload else cls()


def combined(*values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of several mappings; a later one counts more, but not if it has no value.

    Each key of `metadata` is combined for itself.
    """
    result: dict[str, Any] = {}
    for some in values:
        for name, value in some.items():
            if name == "metadata":
                result[name] = combined(result.get(name, {}), value or {})
            elif name not in result or value not in (None, "", ()):
                result[name] = value
    return result
