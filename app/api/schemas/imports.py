"""Imports."""

from __future__ import annotations

from typing import Any

from pydantic import Field, Json

from app.api.schemas.base import FormWords, Incoming, Label, MetadataChanges
from app.services.imports.options import ImportOptions
from app.services.imports.path_pattern import MAX_PATTERN, PATTERN_OF_PATHS

_FOR_ALL = "For all files whose rows in a manifest and whose paths give none."


class ImportForm(Incoming):
    """The text fields that come with an archive. A manifest in the archive counts more."""

    person: Label | None = Field(None, description=_FOR_ALL)
    task: Label | None = Field(None, description=_FOR_ALL)
    words: FormWords | None = Field(None, description=f"{_FOR_ALL} Separated by spaces.")
    license: Label | None = Field(None, description=_FOR_ALL)
    source: Label | None = Field(None, description=_FOR_ALL)
    metadata: Json[MetadataChanges] | None = Field(
        None, description=f"JSON: values of your own by key. {_FOR_ALL}"
    )
    labels: str | None = Field(
        None,
        max_length=MAX_PATTERN,
        json_schema_extra={"pattern": PATTERN_OF_PATHS},
        description="Labels from the paths of files: a pattern like `{person}/{task}/{take}.bvh`."
        " A name in braces that is no label becomes metadata; `*` is any name, `**` any folders.",
        examples=["{person}/{task}/{take}.bvh"],
    )
    overwrite: bool = Field(
        False,
        description="Whether a label that comes now replaces one that somebody edited since an"
        " earlier import. By default it does not, and the file is `conflicting`.",
    )

    def options(self) -> ImportOptions:
        """The options of the import."""
        values: dict[str, Any] = self.model_dump(
            exclude_none=True, exclude={"labels", "overwrite", "metadata"}
        )
        if self.metadata is not None:
            values["metadata"] = self.metadata
        return ImportOptions(values, self.labels, self.overwrite)
